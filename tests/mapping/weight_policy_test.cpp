// SPDX-License-Identifier: MIT
#include <surfleet/mapping/weight_policy.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
template <WeightPolicy W>
void weight_laws(const W& weight) {
  for (double sdf = -1.0; sdf <= 1.0; sdf += 0.1)
    for (double range = 0.0; range < 20.0; range += 0.37) {
      const double w = weight(sdf, range);
      CHECK(w >= 0.0 && std::isfinite(w));
      CHECK(w >= weight(sdf, range + 0.5));  // none of ours grows with range
      const float quick = detail::observation_weight(weight, static_cast<float>(sdf),
                                                     static_cast<float>(range * range));
      CHECK_NEAR(quick, w, 1e-5 * (1.0 + w));
    }
}
}  // namespace

TEST(all_weights_keep_the_laws) {
  weight_laws(ConstantWeight{});
  weight_laws(ConstantWeight{0.25});
  weight_laws(InverseSquareWeight{});
  weight_laws(InverseSquareWeight{.exponent = 1.0});
  weight_laws(InverseSquareWeight{.exponent = 0.0});
  weight_laws(DropOffWeight<>{});
  weight_laws(DropOffWeight<ConstantWeight>{});
}

TEST(weights_have_their_values) {
  CHECK_NEAR(InverseSquareWeight{}(0.0, 8.0), 0.015625, 1e-12);
  CHECK_NEAR((InverseSquareWeight{.nearest = 0.5}(0.0, 0.0)), 4.0, 1e-12);
  CHECK_NEAR((DropOffWeight<ConstantWeight>{}(-0.125, 1.0)), 0.5, 1e-12);
  CHECK((DropOffWeight<ConstantWeight>{}(-0.3, 1.0)) == 0.0);
}
