/// \file `solver.budget: real_time` becomes a number of substeps when a scene is loaded.

#include "cloth_sim/sim/real_time.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "cloth_sim/scene/load.h"
#include "cloth_sim/sim/simulation.h"
#include "unit/scene_support.h"

namespace cloth_sim {
namespace {

using testing::HasSubstr;

const char* const kSwing = R"(
cloth:
  size: [0.8, 0.8]
  particles: [20, 20]
  pose: {position: [0, 0, 1], rpy: [0.6, 0, 0]}
  fabric: {preset: silk}
  pins: [last_row]
solver: {error: 0.002, budget: real_time}
)";

class RealTime : public testing::Test {
 protected:
  void SetUp() override {
    char name[] = "/tmp/real_time_test_XXXXXX";
    folder_ = mkdtemp(name);
    file_ = folder_ + "/cache/real_time.csv";
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  CalibrationSettings settings() {
    CalibrationSettings settings;
    settings.file = CalibrationFile(file_);
    settings.threads = 1;
    settings.tell = [this](const std::string& line) { told_.push_back(line); };
    return settings;
  }

  Scene load(const CalibrationSettings& settings) const {
    return loadForThisMachine(
        [](const auto& overrides) { return parseScene(kSwing, "swing.yaml", overrides); },
        settings);
  }

  /// The scene on a machine whose substeps take so many seconds.
  Scene loadWith(double perSubstep) {
    CalibrationFile(file_).add(key(), {1e-3, perSubstep});
    return load(settings());
  }

  static CalibrationKey key() { return calibrationKeyOf(parseScene(kSwing, "swing.yaml"), 1); }

  std::string fileText() const {
    std::ifstream in(file_);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  std::string folder_;
  std::string file_;
  std::vector<std::string> told_;
};

TEST(RealTimeSubsteps, FitIntoTheirTime) {
  EXPECT_EQ(substepsIn(0.0165, {0.002, 0.001}), 14);
  EXPECT_EQ(substepsIn(1.0, {0.0, 1e-9}), 100000);
  EXPECT_EQ(substepsIn(0.02, {0.1, 0.001}), 1) << "does not fit at all";
}

TEST(RealTimeSubsteps, HaveLessTimeWhereContactsAreToCome) {
  const auto fractionOf = [](const std::string& more) {
    return realTimeFraction(parseScene(kSwing + more, "swing.yaml"));
  };
  EXPECT_EQ(fractionOf(""), 0.8);
  EXPECT_EQ(fractionOf("obstacles: {floor: {type: plane}}"), 0.6);
  EXPECT_EQ(fractionOf("clamps: {hand: {patch: {particle: [2, 2]}}}"), 0.6);
  EXPECT_EQ(fractionOf("tearing: {ratio: 2}"), 0.6);
}

TEST_F(RealTime, IsMeasuredOnceAndThenTakenFromTheFile) {
  const Scene first = load(settings());
  ASSERT_TRUE(first.solver.realTimeBudget);
  EXPECT_GE(*first.solver.realTimeBudget, 1);
  EXPECT_EQ(first.solver.parameters.at("budget"), *first.solver.realTimeBudget);
  const std::string before = fileText();
  const Scene second = load(settings());
  EXPECT_EQ(second.solver.parameters, first.solver.parameters);
  EXPECT_EQ(second.text, first.text);
  EXPECT_EQ(fileText(), before);
  ASSERT_EQ(told_.size(), 2U) << "one line for each";
  EXPECT_THAT(told_[0], HasSubstr("measured now"));
  EXPECT_THAT(told_[1], HasSubstr(file_));
  CalibrationSettings again = settings();
  again.again = true;
  load(again);
  EXPECT_THAT(told_[2], HasSubstr("measured now"));
}

TEST_F(RealTime, FollowsFromTheCalibrationAlone) {
  // (0.8 / 60 - 0.001) s / 0.0005 s = 24.7
  const Scene scene = loadWith(5e-4);
  EXPECT_EQ(scene.solver.parameters.at("budget"), 24.0);
  ASSERT_EQ(told_.size(), 1U);
  EXPECT_THAT(told_[0], HasSubstr("solver.budget real_time: 24 substeps in a step of 16.7 ms"));
  EXPECT_THAT(scene.text, HasSubstr("real_time: 24"));
  EXPECT_EQ(loadWith(2.5e-4).solver.parameters.at("budget"), 49.0);
}

TEST_F(RealTime, ARecordedSceneHasTheSameBitsWithAnotherCalibration) {
  Simulation recorded(loadWith(1e-3));  // 12 substeps: too few for the error
  loadWith(2.5e-4);
  Simulation replayed(parseScene(recorded.scene().text, "swing.yaml"));
  EXPECT_EQ(replayed.scene().solver.parameters.at("budget"), 12.0);
  for (int k = 0; k < 20; ++k) {
    recorded.step();
    replayed.step();
  }
  EXPECT_EQ(recorded.lastReport().substeps, 12);
  EXPECT_EQ(replayed.save(), recorded.save());
}

TEST_F(RealTime, ASavedStateGoesOnToTheBitWithAnotherCalibration) {
  Simulation saved(loadWith(1e-3));
  for (int k = 0; k < 20; ++k) saved.step();
  Simulation other(loadWith(2.5e-4));
  ASSERT_EQ(other.scene().solver.parameters.at("budget"), 49.0);
  const CommandResult loaded = other.apply(Restore{saved.save()});
  ASSERT_TRUE(loaded.success) << loaded.message;
  for (int k = 0; k < 20; ++k) {
    saved.step();
    other.step();
    ASSERT_EQ(other.lastReport().substeps, 12);
  }
  EXPECT_EQ(other.lastReport().error->budget, 12);
  EXPECT_EQ(other.save(), saved.save());
}

TEST_F(RealTime, AStateOfACountedBudgetIsOfAnotherScene) {
  const Scene counted = parseScene(kSwing, "swing.yaml", {"solver.budget=12"});
  Simulation other(loadWith(1e-3));
  EXPECT_FALSE(other.apply(Restore{Simulation(counted).save()}).success);
}

TEST_F(RealTime, ABadFileIsSaidInOneLineAndMeasuredAgain) {
  std::filesystem::create_directory(folder_ + "/cache");
  for (const char* bad : {"no table", "machine,method\n1,2\n", "\x01\x02\n,,\n"}) {
    std::ofstream(file_) << bad;
    told_.clear();
    EXPECT_TRUE(load(settings()).solver.realTimeBudget);
    ASSERT_EQ(told_.size(), 2U) << bad;
    EXPECT_THAT(told_[0], testing::AllOf(HasSubstr(file_ + ": line 1"), HasSubstr("again")));
    EXPECT_EQ(told_[0].find('\n'), std::string::npos);
    EXPECT_TRUE(CalibrationFile(file_).find(key())) << "it has been replaced";
  }
  for (const char* cost : {"nan,1", "1,nan", "-1,1", "0.1,0", "0.1,-3", "inf,1", "1,inf", "a,b"}) {
    std::string text = fileText();
    text.resize(text.rfind(key().text()));
    std::ofstream(file_) << text << key().text() << ',' << cost << '\n';
    told_.clear();
    load(settings());
    EXPECT_EQ(told_.size(), 2U) << cost;
  }
}

TEST_F(RealTime, AFileThatCannotBeWrittenIsSaidInOneLine) {
  std::ofstream(folder_ + "/cache") << "a file where the folder should be";
  EXPECT_TRUE(load(settings()).solver.realTimeBudget);
  ASSERT_EQ(told_.size(), 2U);
  EXPECT_THAT(told_[0], testing::AllOf(HasSubstr(file_), HasSubstr("next time")));
}

TEST_F(RealTime, IsNotMeasuredWhereNothingTakesABudget) {
  for (const char* set : {"solver.method=verlet", "solver.substeps=20", "solver.budget=9"}) {
    const Scene scene = loadForThisMachine(
        [set](std::vector<std::string> overrides) {
          overrides.insert(overrides.begin(), set);
          return parseScene(kSwing, "swing.yaml", overrides);
        },
        settings());
    EXPECT_FALSE(scene.solver.realTimeBudget) << set;
  }
  EXPECT_TRUE(told_.empty());
  EXPECT_FALSE(std::filesystem::exists(file_));
}

TEST(RealTimeScene, IsRefusedByASimulationUntilItIsResolved) {
  try {
    Simulation simulation(parseScene(kSwing, "swing.yaml"));
    FAIL() << "it runs";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("loadForThisMachine"));
  }
}

TEST(RealTimeScene, RefusesOtherWordsInOneLine) {
  const auto refusal = [](const std::string& budget) {
    return testing_support::sceneErrorOf(
        [&] { parseScene(kSwing, "swing.yaml", {"solver.budget=" + budget}); });
  };
  EXPECT_EQ(refusal("fast"),
            "swing.yaml:8: solver.budget: expected a whole number from 1 to 100000, or real_time "
            "(got 'fast', by an override)");
  for (const char* bad : {"0", "-3", "1.5", ".nan", "[3]", "true", "{real_time: 0}", "{fast: 3}",
                          "{real_time: soon}", "{}"}) {
    EXPECT_THAT(refusal(bad), HasSubstr("solver.budget")) << bad;
  }
}

}  // namespace
}  // namespace cloth_sim
