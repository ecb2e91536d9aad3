// SPDX-License-Identifier: Apache-2.0
// Tiles: how work-groups share a picture when they need memory of their own for a part of it.
typedef struct {
  int x, y, columns, rows;  // its pixels; columns: rounded up to whole vectors
} Tile;

// Tile number n of those of columns x rows (whole vectors) over [x0, x1) x [y0, y1).
Tile tile_of(int n, int x0, int y0, int x1, int y1, int columns, int rows) {
  const int across = (x1 - x0 + columns - 1) / columns;
  Tile t;
  t.x = x0 + n % across * columns;
  t.y = y0 + n / across * rows;
  t.columns = (min(columns, x1 - t.x) + VW - 1) / VW * VW;
  t.rows = min(rows, y1 - t.y);
  return t;
}
int tiles_of(int x0, int y0, int x1, int y1, int columns, int rows) {
  return (x1 - x0 + columns - 1) / columns * ((y1 - y0 + rows - 1) / rows);
}

// Number of the work-group, and of all.
int group_number() { return get_group_id(1) * get_num_groups(0) + get_group_id(0); }
int group_count() { return get_num_groups(0) * get_num_groups(1); }

// A work-group's items share the columns of a tile.
#define FOR_EACH_SHARED(i, width) for (int i = get_local_id(0) * VW; i < (width); i += get_local_size(0) * VW)
