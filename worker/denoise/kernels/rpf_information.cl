// SPDX-License-Identifier: Apache-2.0
// How much the numbers of a neighbourhood's samples tell of one another: mutual information of histograms (van de
// Vlasakker 2013, equation 5.3 and algorithm 7), of all pairs that Random Parameter Filtering asks for.
//
// A histogram of two numbers counts samples that are in bucket a of the one and bucket b of the other. With a bit per
// sample that says "is in bucket a", that is the number of bits that two masks share: 512 samples are counted at once.
// Buckets in the middle have no mask: they hold whatever the others leave.
#define NUMBERS 27                                 // that histograms are made of: a line's first ones
#define RANDOM 16                                  // from here on lie those that features are paired with
#define COLUMNS (NUMBERS - RANDOM)                 // random parameters, screen, colour
#define ROWS (16 + 3)                              // features, colour
#define MOST_MASKS 14                              // of a number: 15 buckets but the middle one
#define BLOCK 15                                   // vectors of 512 samples that are counted in one go
#define BLOCK_SAMPLES (512 * BLOCK)
#define MOST_COLUMN_MASKS (16 * ((COLUMNS * MOST_MASKS + 15) / 16))
#define UNIT (1.0f / 16384)                        // of the table of n log2 n

typedef struct {
  int buckets;
  int first[NUMBERS + 1];          // mask of each number, columns before features
  int low[NUMBERS], high[NUMBERS];  // buckets that are in use
  uint total[NUMBERS * MOST_MASKS + 16];  // samples of each mask
  uint pairs[ROWS * MOST_MASKS][MOST_COLUMN_MASKS];
  ulong8 masks[NUMBERS * MOST_MASKS + 16][BLOCK];
} Histograms;

// One bucket a standard deviation; what is farther out is in the last one.
int16 bucket_of(float16 value, float16 mean, float16 inverse_deviation, int buckets) {
  const float16 z = fma(value - mean, inverse_deviation, (float16)(0.5f * (float)buckets));
  const float16 most = (float)buckets - 0.5f;
  return convert_int16(z > 0.0f ? (z < most ? z : most) : (float16)0.0f);
}

// Order of the masks: random parameters, screen and colour first, for those are the columns.
int number_at(int place) { return place < COLUMNS ? RANDOM + place : place - COLUMNS; }

// Rows are the features, then the colours, whose masks are the last of the columns'.
int row_mask(const Histograms* h, int row) { return h->first[row < 16 ? COLUMNS + row : COLUMNS - 3 + row - 16]; }
int row_masks(const Histograms* h, int row) {
  const int place = row < 16 ? COLUMNS + row : COLUMNS - 3 + row - 16;
  return h->first[place + 1] - h->first[place];
}
// Colours are not paired with themselves.
int row_columns(int row) { return row < 16 ? COLUMNS : COLUMNS - 3; }

void set_up(Histograms* restrict h, const Neighbours* restrict n, int buckets) {
  h->buckets = buckets;
  for (int v = 0; v < 2; ++v) {
    int low[16], high[16];
    vstore16(bucket_of(n->low[v], n->mean[v], n->inverse_deviation[v], buckets), 0, low);
    vstore16(bucket_of(n->high[v], n->mean[v], n->inverse_deviation[v], buckets), 0, high);
    for (int k = 0; k < 16 && 16 * v + k < NUMBERS; ++k) {
      h->low[16 * v + k] = low[k];
      h->high[16 * v + k] = high[k];
    }
  }
  int mask = 0;
  for (int place = 0; place < NUMBERS; ++place) {
    const int k = number_at(place), middle = buckets / 2;
    h->first[place] = mask;
    mask += h->high[k] - h->low[k] + !(h->low[k] <= middle && middle <= h->high[k]);
  }
  h->first[NUMBERS] = mask;
  for (int m = 0; m < mask; ++m) h->total[m] = 0;
  for (int row = 0; row < ROWS; ++row)
    for (int m = 0; m < row_masks(h, row); ++m)
      for (int c = 0; c < h->first[row_columns(row)]; c += 16) vstore16((uint16)0, 0, h->pairs[row * MOST_MASKS + m] + c);
}

// Buckets of samples first .. first + count of the neighbourhood, four bits each, eight samples a word: of number k in
// words[k]. Behind the last sample, buckets in the middle.
void encode(uint words[NUMBERS][BLOCK_SAMPLES / 8], const Neighbours* restrict n, global const float* restrict samples,
            int first, int count, int buckets) {
  const uint16 middle = 0x11111111u * (uint)(buckets / 2);
  uint lanes[32];
  for (int g = 0; g < (count + 511) / 512 * 64; ++g) {
    uint16 word0 = 0, word1 = 0;
    const int here = count - 8 * g;
    if (here <= 0) {
      word0 = word1 = middle;
    } else {
      for (int k = 0; k < 8; ++k) {
        uint16 code0 = middle & 15, code1 = middle & 15;
        if (k < here) {
          global const float* line = samples + (size_t)n->at[first + 8 * g + k] * LINE;
          code0 = convert_uint16(bucket_of(vload16(0, line), n->mean[0], n->inverse_deviation[0], buckets));
          code1 = convert_uint16(bucket_of(vload16(1, line), n->mean[1], n->inverse_deviation[1], buckets));
        }
        word0 = word0 << 4 | code0;
        word1 = word1 << 4 | code1;
      }
    }
    vstore16(word0, 0, lanes);
    vstore16(word1, 1, lanes);
    for (int k = 0; k < NUMBERS; ++k) words[k][g] = lanes[k];
  }
}

// Bits of a vector, counted in 64 of them at a time.
ulong8 bits_of(ulong8 x) {
  x -= x >> 1 & 0x5555555555555555ul;
  x = (x & 0x3333333333333333ul) + (x >> 2 & 0x3333333333333333ul);
  x = (x + (x >> 4)) & 0x0f0f0f0f0f0f0f0ful;
  return (x * 0x0101010101010101ul) >> 56;
}

uint sum_of(ulong8 v) {
  const ulong4 a = v.lo + v.hi;
  const ulong2 b = a.lo + a.hi;
  return (uint)(b.x + b.y);
}

// Masks of one number, and how many bits each has.
void make_masks(Histograms* restrict h, int place, const uint* restrict words, int vectors) {
  const int k = number_at(place);
  ulong8 planes[BLOCK][4];
  for (int v = 0; v < vectors; ++v) {
    const uint16 a = vload16(4 * v, words), b = vload16(4 * v + 1, words), c = vload16(4 * v + 2, words),
                 d = vload16(4 * v + 3, words);
#pragma unroll
    for (int p = 0; p < 4; ++p)
      planes[v][p] = as_ulong8((a >> p & 0x11111111u) | (b >> p & 0x11111111u) << 1 | (c >> p & 0x11111111u) << 2 |
                               (d >> p & 0x11111111u) << 3);
  }
  int mask = h->first[place];
  for (int bucket = h->low[k]; bucket <= h->high[k]; ++bucket) {
    if (bucket == h->buckets / 2) continue;
    const ulong8 f0 = bucket & 1 ? 0 : ~0ul, f1 = bucket & 2 ? 0 : ~0ul, f2 = bucket & 4 ? 0 : ~0ul,
                 f3 = bucket & 8 ? 0 : ~0ul;
    ulong8 bits = 0;
    for (int v = 0; v < vectors; ++v) {
      const ulong8 m = (planes[v][0] ^ f0) & (planes[v][1] ^ f1) & (planes[v][2] ^ f2) & (planes[v][3] ^ f3);
      h->masks[mask][v] = m;
      bits += bits_of(m);
    }
    // Counters take 1, 3, 7 or 15 vectors.
    for (int v = vectors; v > 1 && (v & (v + 1)) != 0; ++v) h->masks[mask][v] = 0;
    h->total[mask++] += sum_of(bits);
  }
}

// Carry-save addition of three numbers of one bit, in every bit of a vector: the sum's low and high bit.
#define LOW(a, b, c) (a ^ b ^ c)
#define HIGH(a, b, c) ((a & b) | (c & (a | b)))
#define SHARED(v) (mask[v] & other[v])

// How many bits two masks of 1, 3, 7 or 15 vectors share, in 64 of each. Shifted as numbers of 32 bits: compilers know
// bits_of to be one instruction or a few, but not once they have drawn a shift into it.
#define TIMES(factor_bits, x) as_ulong8(as_uint16(bits_of(x)) << factor_bits)
ulong8 shared1(const ulong8* restrict mask, const ulong8* restrict other) { return bits_of(SHARED(0)); }
ulong8 shared3(const ulong8* restrict mask, const ulong8* restrict other) {
  const ulong8 a = SHARED(0), b = SHARED(1), c = SHARED(2);
  return bits_of(LOW(a, b, c)) + TIMES(1, HIGH(a, b, c));
}
#define ADD6(first, carried)                                                                             \
  const ulong8 a##first = SHARED(first), b##first = SHARED(first + 1), c##first = SHARED(first + 2),     \
               d##first = SHARED(first + 3), e##first = SHARED(first + 4), f##first = SHARED(first + 5), \
               low1##first = LOW(carried, a##first, b##first), high1##first = HIGH(carried, a##first, b##first), \
               low2##first = LOW(low1##first, c##first, d##first),                                       \
               high2##first = HIGH(low1##first, c##first, d##first),                                     \
               ones##first = LOW(low2##first, e##first, f##first),                                       \
               high3##first = HIGH(low2##first, e##first, f##first),                                     \
               twos##first = LOW(high1##first, high2##first, high3##first),                              \
               fours##first = HIGH(high1##first, high2##first, high3##first);
ulong8 shared7(const ulong8* restrict mask, const ulong8* restrict other) {
  const ulong8 start = SHARED(6);
  ADD6(0, start)
  return bits_of(ones0) + TIMES(1, twos0) + TIMES(2, fours0);
}
ulong8 shared15(const ulong8* restrict mask, const ulong8* restrict other) {
  const ulong8 start = SHARED(12), m = SHARED(13), n = SHARED(14);
  ADD6(0, start)
  ADD6(6, ones0)
  const ulong8 ones = LOW(ones6, m, n), high = HIGH(ones6, m, n), twos = LOW(twos0, twos6, high),
               more = HIGH(twos0, twos6, high), fours = LOW(fours0, fours6, more), eights = HIGH(fours0, fours6, more);
  return bits_of(ones) + TIMES(1, twos) + TIMES(2, fours) + TIMES(3, eights);
}

// Sums of pairs of lanes, of a in front, of b behind.
ulong8 paired(ulong8 a, ulong8 b) { return (ulong8)(a.even + a.odd, b.even + b.odd); }

// Adds how many bits a mask shares with each of sixteen others: at most 7680, so that four of them are summed in one
// number of 64 bits.
ulong8 packed(ulong8 a, ulong8 b, ulong8 c, ulong8 d) {
  const uint16 low = as_uint16(a) | as_uint16(b) << 16, high = as_uint16(c) | as_uint16(d) << 16;
  return as_ulong8(low) | as_ulong8(high) << 32;
}
#define FOUR(count, i) \
  packed(count(mask, others[i]), count(mask, others[i + 1]), count(mask, others[i + 2]), count(mask, others[i + 3]))
#define SIXTEEN(count) paired(paired(FOUR(count, 0), FOUR(count, 4)), paired(FOUR(count, 8), FOUR(count, 12)))
void add_shared(uint* restrict pairs, const ulong8* restrict mask, ulong8 others[16][BLOCK], int vectors) {
  ulong8 sums;
  if (vectors == 1)
    sums = SIXTEEN(shared1);
  else if (vectors <= 3)
    sums = SIXTEEN(shared3);
  else if (vectors <= 7)
    sums = SIXTEEN(shared7);
  else
    sums = SIXTEEN(shared15);
  vstore16(vload16(0, pairs) + convert_uint16(as_ushort16(sums.even + sums.odd)), 0, pairs);
}

void count_pairs(Histograms* restrict h, const Neighbours* restrict n, global const float* restrict samples) {
  uint words[NUMBERS][BLOCK_SAMPLES / 8];
  for (int first = 0; first < n->count; first += BLOCK_SAMPLES) {
    const int count = min(n->count - first, BLOCK_SAMPLES), vectors = (count + 511) / 512;
    encode(words, n, samples, first, count, h->buckets);
    for (int place = 0; place < NUMBERS; ++place) make_masks(h, place, words[number_at(place)], vectors);
    for (int c = 0; c < h->first[COLUMNS]; c += 16)
      for (int row = 0; row < ROWS; ++row)
        for (int m = 0; c < h->first[row_columns(row)] && m < row_masks(h, row); ++m)
          add_shared(h->pairs[row * MOST_MASKS + m] + c, h->masks[row_mask(h, row) + m], h->masks + c, vectors);
  }
}

// Mutual information of a row with each column, in bits: H(X) + H(Y) - H(X, Y) with H = log2 N - sum(n log2 n) / N. The
// table holds n log2 n in whole units, so that the sums are exact; they wrap around, their difference does not.
void information(const Histograms* restrict h, int count, int row, global const uint* restrict table,
                 float* restrict result) {
  const int masks = row_masks(h, row), columns = row_columns(row);
  uint left[MOST_COLUMN_MASKS], joint[COLUMNS], in_row = 0, middle = count;
  for (int c = 0; c < h->first[columns]; ++c) left[c] = h->total[c];
  for (int c = 0; c < columns; ++c) joint[c] = 0;
  for (int m = 0; m < masks; ++m) {
    const uint total = h->total[row_mask(h, row) + m];
    const uint* pairs = h->pairs[row * MOST_MASKS + m];
    middle -= total;
    in_row += table[total];
    for (int c = 0; c < columns; ++c) {
      uint rest = total, sum = 0;
      for (int k = h->first[c]; k < h->first[c + 1]; ++k) {
        sum += table[pairs[k]];
        rest -= pairs[k];
        left[k] -= pairs[k];
      }
      joint[c] += sum + table[rest];
    }
  }
  in_row += table[middle];
  for (int c = 0; c < columns; ++c) {
    uint rest = middle, in_column = 0, in_middle = count;
    for (int k = h->first[c]; k < h->first[c + 1]; ++k) {
      joint[c] += table[left[k]];
      rest -= left[k];
      in_column += table[h->total[k]];
      in_middle -= h->total[k];
    }
    joint[c] += table[rest];
    in_column += table[in_middle];
    const int units = (int)(table[count] + joint[c] - in_row - in_column);
    result[c] = UNIT * (float)max(units, 0) / (float)count;
  }
}
