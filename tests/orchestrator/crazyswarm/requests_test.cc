// What scripts for Crazyswarm2 send, and what they are answered, byte by byte.
#include "orchestrator/crazyswarm/requests.h"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <numbers>

#include "tests/support/cdr_sample.h"

namespace mascot::crazyswarm {
namespace {

using Eigen::Vector3d;
using test::ExpectNoneOfTheCut;
using test::Sample;

constexpr std::uint8_t kGroup = 0;

TEST(CrazyswarmRequests, OrdersAreRead) {
  Sample height;
  height.Add(kGroup).Add(0.5F).Add(std::int32_t{2}).Add(std::uint32_t{500'000'000});
  EXPECT_EQ(ReadHeight(height.bytes())->height_m, 0.5);
  EXPECT_EQ(ReadHeight(height.bytes())->duration_s, 2.5);
  ExpectNoneOfTheCut(height, [](const Bytes& sample) { return ReadHeight(sample); });

  Sample goal;
  goal.Add(kGroup).Add(std::uint8_t{1}).Doubles({1, 2, 3}).Add(0.1F).Add(std::int32_t{4}).Add(std::uint32_t{0});
  const auto go = ReadGoTo(goal.bytes());
  EXPECT_TRUE(go->relative);
  EXPECT_EQ(go->goal, Vector3d(1, 2, 3));
  EXPECT_EQ(go->duration_s, 4);
  ExpectNoneOfTheCut(goal, [](const Bytes& sample) { return ReadGoTo(sample); });

  Sample arm;
  arm.Add(std::uint8_t{1});
  EXPECT_TRUE(*ReadArm(arm.bytes()));

  Sample follow;
  follow.Add(kGroup).Add(std::uint8_t{7}).Add(1.5F).Add(std::uint8_t{1}).Add(std::uint8_t{0});
  const auto trajectory = ReadFollow(follow.bytes());
  EXPECT_EQ(trajectory->trajectory, 7);
  EXPECT_EQ(trajectory->timescale, 1.5);
  EXPECT_TRUE(trajectory->reversed);
  EXPECT_FALSE(trajectory->relative);
  ExpectNoneOfTheCut(follow, [](const Bytes& sample) { return ReadFollow(sample); });
}

/// A trajectory of this many pieces, each with `coefficients` of an axis.
Sample Upload(std::uint32_t pieces, std::uint32_t coefficients, std::int32_t seconds = 1) {
  Sample upload;
  upload.Add(std::uint8_t{7}).Add(std::uint32_t{1}).Add(pieces);
  for (std::uint32_t piece = 0; piece < pieces; ++piece) {
    for (int axis = 0; axis < 4; ++axis) {
      upload.Add(coefficients);
      for (std::uint32_t k = 0; k < coefficients; ++k)
        upload.Add(static_cast<float>(10 * axis) + static_cast<float>(k));
    }
    upload.Add(seconds).Add(std::uint32_t{0});
  }
  return upload;
}

TEST(CrazyswarmRequests, TrajectoriesAreRead) {
  const auto upload = ReadUpload(Upload(2, 8).bytes());
  ASSERT_EQ(upload->pieces.size(), 2U);
  EXPECT_EQ(upload->trajectory, 7);
  EXPECT_EQ(upload->offset, 1U);
  EXPECT_EQ(upload->pieces[1].axes[2][7], 27);
  EXPECT_EQ(upload->pieces[1].duration_s, 1);
  EXPECT_EQ(ReadUpload(Upload(1, 3).bytes())->pieces[0].axes[1][3], 0) << "those that are missing";
  EXPECT_FALSE(ReadUpload(Upload(1, 9).bytes()));
  ExpectNoneOfTheCut(Upload(1, 8), [](const Bytes& sample) { return ReadUpload(sample); });
  Sample endless;
  endless.Add(std::uint8_t{7}).Add(std::uint32_t{0}).Add(0xffffffffU);
  EXPECT_FALSE(ReadUpload(endless.bytes()));
}

TEST(CrazyswarmRequests, SetpointsAreRead) {
  Sample full;
  full.Header("world").Doubles({1, 2, 3, 0, 0, 0, 1, 4, 5, 6, 0, 0, 0, 7, 8, 9});
  const auto state = ReadFullState(full.bytes());
  EXPECT_EQ(state->p_W, Vector3d(1, 2, 3));
  EXPECT_EQ(state->v_W, Vector3d(4, 5, 6));
  EXPECT_EQ(state->a_W, Vector3d(7, 8, 9));
  ExpectNoneOfTheCut(full, [](const Bytes& sample) { return ReadFullState(sample); });

  Sample position;
  position.Header("").Add(1.0F).Add(2.0F).Add(3.0F).Add(0.0F);
  EXPECT_EQ(ReadPosition(position.bytes())->p_W, Vector3d(1, 2, 3));

  Sample velocity;
  velocity.Header("world").Doubles({1, 2, 3}).Add(0.0F);
  EXPECT_TRUE(ReadVelocityWorld(velocity.bytes())->p_W.array().isNaN().all());
  EXPECT_EQ(ReadVelocityWorld(velocity.bytes())->v_W, Vector3d(1, 2, 3));

  Sample hover;
  hover.Header("").Add(1.0F).Add(0.0F).Add(0.0F).Add(0.5F);
  const auto ahead = ReadHover(hover.bytes(), std::numbers::pi / 2);
  EXPECT_TRUE(ahead->v_W.isApprox(Vector3d(0, 1, 0), 1e-12)) << "it looks along y";
  EXPECT_EQ(ahead->p_W.z(), 0.5);
  EXPECT_TRUE(std::isnan(ahead->p_W.x()));
}

TEST(CrazyswarmRequests, WhatCannotBeIsRefused) {
  EXPECT_FALSE(ReadUpload(Upload(2, 8, -1).bytes())) << "a piece that ends before it begins";
  const auto takeoff = [](float height_m, std::int32_t seconds) {
    return ReadHeight(Sample().Add(kGroup).Add(height_m).Add(seconds).Add(std::uint32_t{0}).bytes());
  };
  EXPECT_TRUE(takeoff(0.5F, 0));
  EXPECT_FALSE(takeoff(0.5F, -1));
  EXPECT_FALSE(takeoff(0.5F, 2'000'000));
  const auto follow = [](float timescale) {
    return ReadFollow(Sample().Add(kGroup).Add(kGroup).Add(timescale).Add(kGroup).Add(kGroup).bytes());
  };
  EXPECT_TRUE(follow(2));
  for (const float timescale : {0.0F, -1.0F}) EXPECT_FALSE(follow(timescale)) << timescale;
  for (const double wrong : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e7}) {
    const auto narrow = static_cast<float>(wrong);
    EXPECT_FALSE(takeoff(narrow, 1)) << wrong;
    EXPECT_FALSE(follow(narrow)) << wrong;
    const Sample goal = Sample().Add(kGroup).Add(kGroup).Doubles({1, 2, wrong}).Add(0.0F);
    EXPECT_FALSE(ReadGoTo(Sample(goal).Add(std::int32_t{1}).Add(std::uint32_t{0}).bytes())) << wrong;
    EXPECT_FALSE(ReadVelocityWorld(Sample().Header("").Doubles({wrong, 0, 0}).Add(0.0F).bytes())) << wrong;
    EXPECT_FALSE(ReadPosition(Sample().Header("").Add(narrow).Add(0.0F).Add(0.0F).Add(0.0F).bytes())) << wrong;
    EXPECT_FALSE(ReadHover(Sample().Header("").Add(0.0F).Add(narrow).Add(0.0F).Add(0.0F).bytes(), 0)) << wrong;
    for (const std::size_t place : {0U, 8U, 14U}) {  // position, velocity, acceleration
      std::array<double, 16> numbers = {};
      numbers.at(place) = wrong;
      Sample state = Sample().Header("");
      for (const double number : numbers) state.Add(number);
      EXPECT_FALSE(ReadFullState(state.bytes())) << wrong;
    }
  }
}

TEST(CrazyswarmRequests, ParametersAreAnswered) {
  Sample names;
  names.Add(std::uint32_t{2}).Text("a").Text("bc");
  EXPECT_EQ(ReadNames(names.bytes()), (std::vector<std::string>{"a", "bc"}));
  EXPECT_EQ(ReadCount(names.bytes()), 2U);
  Sample many;
  many.Add(std::uint32_t{1'000'000});
  EXPECT_FALSE(ReadCount(many.bytes()));
  EXPECT_FALSE(ReadNames(many.bytes()));

  Sample answer;
  const auto empty = [&](int lists) {
    for (int k = 0; k < lists; ++k) answer.Add(std::uint32_t{0});
  };
  answer.Add(std::uint32_t{1}).Add(std::uint8_t{8}).Add(std::uint8_t{0}).Add(std::int64_t{0}).Add(0.0).Text("");
  empty(3);
  answer.Add(std::uint32_t{3}).Doubles({1, 2, 3});
  empty(1);
  EXPECT_EQ(ParametersReply({{.position = Vector3d(1, 2, 3)}}), answer.bytes());
  EXPECT_EQ(EmptyReply(), Sample().Add(std::uint8_t{0}).bytes());
}

TEST(CrazyswarmRequests, TopicsSayWhereAndHowACrazyflieIs) {
  Sample pose;
  pose.Add(std::int32_t{1}).Add(std::uint32_t{500'000'000}).Text("world").Doubles({1, 2, 3, 0, 0, 0, 1});
  EXPECT_EQ(PoseSample({.p_WB = {1, 2, 3}}, 1.5), pose.bytes());
  Sample status;
  status.Add(std::int32_t{0}).Add(std::uint32_t{0}).Text("world").Add(std::uint16_t{2 + 8 + 16});
  status.Add(4.1F).Add(std::uint8_t{0}).Add(std::uint8_t{0});
  for (int k = 0; k < 4; ++k) status.Add(std::uint32_t{0});
  status.Add(std::uint16_t{0});
  EXPECT_EQ(StatusSample(true, true, false, 0), status.bytes());
}

}  // namespace
}  // namespace mascot::crazyswarm
