// SPDX-License-Identifier: Apache-2.0
#include "tests/worker/denoise/cases.h"

namespace tessera {
namespace {

// A regression over blocks of a grid.
constexpr FilterCase fit(std::string_view text, bool taa = false) {
  return {.text = text,
          .relative = 1e-5,
          .extreme = 1e-5,
          .of_largest = 5e-4,
          .constant = 1e-6,
          .turns = false,
          .wide_past = false,
          .taa = taa};
}

}  // namespace

const std::vector<FilterCase>& filter_cases() {
  // Exponents carry an error of some ulps of up to 127, cosines are raised to a power of 128, five levels add
  // up. Where light spans 60 decades, the smallest weights decide, and the variance that sets them was
  // decided likewise; variance from the picture is then the rounding of a difference of equal moments.
  static const std::vector<FilterCase> cases{
      {.text = "atrous"},
      // Light less emission may be below 0, and its mean over frames next to it.
      {.text = "atrous:history=on", .of_largest = 1e-9},
      // Clipped is by the deviations of nine pixels, each of which errs; by a firefly's where it is one of
      // them. A squared deviation is the mean of squares less the square of the mean: of nine pixels that are
      // nearly as bright it is rounding.
      {.text = "atrous:levels=2,taa=on",
       .relative = 5e-4,
       .firefly = 2e-7,
       .of_extremes = {.share = 0.005, .of_largest = 1},
       .wide_past = false,
       .taa = true},
      {.text = "bilateral", .parts_sky = false},
      {.text = "box", .parts_sky = false},
      {.text = "cross-bilateral"},
      // Every weight errs by up to 1e-4: that of the only neighbour, a firefly, in the second place.
      {.text = "ddf", .relative = 3e-4, .slow = true},
      {.text = "ddf:direction=neighbours,kw=9", .relative = 3e-4, .slow = true},
      {.text = "ddf:holes=on,kw=15", .relative = 3e-4, .slow = true},
      {.text = "ddf:progressive=on,kw=9", .relative = 3e-4, .slow = true},
      {.text = "gaussian", .parts_sky = false},
      // Fits of up to 4096 pixels in single precision: rounding in the sums is as far below the ridge as that
      // is below them, 1e-4; the fitted light is a sum of terms of both signs.
      fit("bmfr"),
      fit("bmfr:block=8"),
      fit("bmfr:block=64,grids=3"),
      fit("bmfr:grids=2,regularisation=stochastic"),
      fit("bmfr:gradients=on,material=on,normals=squared,positions=on"),
      fit("bmfr:block=16,history=on"),
      fit("bmfr:history=on,test=position"),
      fit("bmfr:block=8,history=on,taa=on", true),
      fit("bmfr:block=8,taa=on", true),
      // The least of seven errors that differ by less than their rounding may be any of them; of these inputs
      // none are, but of one of them turned. Where light spans 60 decades, errors beyond 1e34 are that.
      // Errors that differ by less than is rounded off a variance, 1e-8, are equal: black may take 1e-4 of
      // what is beside it.
      {.text = "sbf", .flushed = 1e-4, .slow = true},
      {.text = "sbf:filters=4,smoothing=2,unfiltered=yes", .flushed = 1e-4, .turns = false},
      // Boxes so small that a picture takes no minutes; rpf_test.cpp has the paper's. What deviates by 1e19
      // has an infinite variance: the colour is then in no bucket, nor in the distance.
      {.text = "rpf:box1=5,box2=3,box3=3,box4=3,diameter=20",
       .relative = 1e-3,
       .squares = true,
       .turns = false,
       .slow = true},
      // A distance that differs from the threshold by less than the rounding of either falls out either way;
      // of these inputs none does. The mean about a firefly is that minus nearly all of it.
      {.text = "rhf", .relative = 5e-4, .slow = true},
      {.text = "rhf:patch=0,gate=3", .relative = 5e-4, .slow = true},
      {.text = "rhf:average=patches,bins=shared", .relative = 5e-4, .slow = true},
      // A scale's low frequencies are taken out and those of the next put in: what is rounded off a firefly's
      // mean reaches its neighbours. Turned, a picture 83 pixels wide has another grid of every fourth pixel.
      {.text = "rhf:scales=2",
       .relative = 5e-4,
       .of_largest = 1e-4,
       .below = 1,
       .constant = 1e-6,
       .slow = true},
      {.text = "rhf:average=patches,gate=3,scales=3",
       .relative = 5e-4,
       .of_largest = 1e-4,
       .below = 1,
       .constant = 1e-6,
       .turns = false,
       .slow = true},
      // Albedos and normals are stored in units of their sigmas: what is rounded off some tens of them is
      // worth 1e-4 of the smallest weights, which decide where the only neighbour is a firefly. A test of
      // means whose sides differ by less than their rounding may fall out either way; of these inputs none
      // does.
      {.text = "statmc", .relative = 5e-4},
      // Covariances are differences of means, over a variance of 0.01 and more; sums run from left to right,
      // whichever way the picture is turned. Depth that is not scaled varies by hundreds of epsilons.
      {.text = "guided",
       .relative = 5e-3,
       .of_largest = 1e-5,
       .constant = 1e-5,
       .turns = false,
       .slow = true},
      {.text = "guided:radius=5,depth_scale=10",
       .relative = 1e-4,
       .of_largest = 1e-5,
       .constant = 1e-5,
       .turns = false},
      {.text = "sure-atrous"},
      // What a level takes out is a colour less a mean of which it is nearly all, where it is a million times
      // brighter than those around: rounding, by whose squares less the noise a weight is chosen. Edges by
      // luminance are differences of such colours, over deviations as small as any.
      {.text = "sure-atrous:edge=svgf,weights=grid", .of_extremes = {.share = 0.01, .of_largest = 1}},
      {.text = "sure-atrous:distance=depth,variance=spatial,window=1", .slow = true},
      {.text = "sure-atrous:mode=literal,edge=svgf,distance=depth", .extreme = 0.1, .slow = true},
      // Shading counts by absolute differences, and that of fireflies, up to 1e6, has steps of 1/16. The
      // difference of two that are rounded errs by a step, at 14 samples 0.175 of s_max / n: a weight by a
      // factor of up to e^0.175 = 1.19, and where it is the only one the result. Only pixels that are
      // lit by fireflies alike weigh anything to each other there: few. Brighter ones have steps as large as
      // any weight's exponent.
      {.text = "fdf",
       .of_fireflies = {.share = 0.05, .relative = 0.2},
       .of_extremes = {.share = 0.01, .of_largest = 1}},
      {.text = "fdf:guides=prefiltered,radius=3",
       .of_fireflies = {.share = 0.05, .relative = 0.2},
       .of_extremes = {.share = 0.01, .of_largest = 1},
       .slow = true},
      // Light beyond what squares fit into a float is left alone. Predictions are sums of terms of both
      // signs, as large as the fireflies in a window: a thousandth of what is left of them is rounding where
      // they nearly cancel. With more than one k it may also be the choice between them, by squared errors of
      // 1e12.
      {.text = "nfor:depth_scale=10",
       .relative = 1e-3,
       .of_largest = 1e-5,
       .of_fireflies = {.share = 0.1, .of_largest = 5e-3},
       .squares = true,
       .below = 1,
       .slow = true},
      {.text = "nfor:depth_scale=10,k_narrow=1",
       .relative = 1e-3,
       .of_largest = 1e-5,
       .of_fireflies = {.share = 0.1, .of_largest = 1e-3},
       .squares = true,
       .below = 1,
       .slow = true},
      {.text = "nlm", .parts_sky = false, .slow = true},
      {.text = "nlm:cut=soft,radius=3,patch=2", .parts_sky = false, .slow = true},
      {.text = "nlm:mode=prefilter", .parts_sky = false, .slow = true},
      {.text = "nlm:mode=prefilter,patch_mode=exp_of_mean", .parts_sky = false, .slow = true},
      // Features count from 0 to 1: prefiltered, they are rounded, and a difference of 0.03 stops the filter.
      // Where two filters are as good as each other, rounding decides which is chosen, and neighbours take a
      // share of that.
      // Black may take some of what is beside it, as of sbf.
      {.text = "rdfc:depth_scale=10",
       .relative = 1e-2,
       .of_denormals = {.share = 0.01, .of_largest = 0.1},
       .flushed = 1e-4,
       .slow = true},
      {.text = "rdfc:depth_scale=10,take=small_patches", .relative = 2e-4, .slow = true},
      {.text = "rdfc:depth_scale=10,take=large_patches", .relative = 2e-4, .slow = true},
      {.text = "rdfc:depth_scale=10,tau_features=0.01,take=features", .extreme = 0.1, .slow = true},
      // Weights err by 6e-7 where normals turn by half a radian, as some do whose first component is missing;
      // of light over albedos of 1e-3, that is up to 6e-4.
      {.text = "svgf", .flushed = 1e-3},
      // Where light spans sixty decades, variances accumulated over frames decide the smallest weights; and
      // of two pixels that were fireflies the difference is what is left of their digits. What does not vary
      // at all has a variance of 0 or of a rounding.
      //
      // Where the variance is the picture's, a firefly's weight on its neighbours errs by nearly 1e-4 for the
      // reasons above. To that add two roundings of an exponent in each of five levels, by up to 32 of 2^23
      // of an octave, which are 2.64e-6 of a weight: 2.64e-5.
      {.text = "svgf:history=on",
       .firefly = 1e-9,
       .of_extremes = {.share = 0.005, .of_largest = 1},
       .of_denormals = {.share = 0.005, .of_largest = 1},
       .flushed = 1e-3},
      {.text = "svgf:history=on,average=exponential,feedback=0,variance=spatial",
       .relative = 1.264e-4,
       .of_largest = 1e-12,
       .squares = true,
       .flushed = 1e-3},
      {.text = "svgf:history=on,feedback=2,variance=spatial",
       .relative = 1.264e-4,
       .of_largest = 1e-12,
       .squares = true,
       .flushed = 1e-3},
      {.text = "svgf:history=on,levels=2,taa=on",
       .relative = 5e-4,
       .firefly = 2e-7,
       .of_extremes = {.share = 0.005, .of_largest = 1},
       .of_denormals = {.share = 0.005, .of_largest = 1},
       .flushed = 1e-3,
       .wide_past = false,
       .taa = true},
      {.text = "svgf:variance=spatial",
       .relative = 1.264e-4,
       .of_extremes = {.share = 0.005, .of_largest = 1},
       .flushed = 1e-3},
  };
  return cases;
}

}  // namespace tessera
