// The work of the node besides stepping, each part alone: the snapshot that the stepping thread
// hands over, and the messages made from it, down to the bytes that a subscriber gets.

#include <benchmark/benchmark.h>

#include "cloth_sim/ros/conversions.h"
#include "cloth_sim/ros/markers.h"
#include "scenes.h"

namespace cloth_sim::bench {
namespace {

constexpr int kWarmUp = 20;
/// Steps from one return to the state after the warm-up to the next.
constexpr int kStretch = 5;

Scene scene(const benchmark::State& run) { return hanging(static_cast<int>(run.range(0)), "xpbd"); }

/// A snapshot of a state that has none yet; stepping is not timed.
void snapshot(benchmark::State& run, Detail detail) {
  Warm warm(scene(run), kWarmUp);
  warm.simulation().snapshot();  // the topology is there, as after the first one of a run
  int since = 0;
  for (auto _ : run) {
    run.PauseTiming();
    if (since++ == kStretch) {
      warm.goBack();
      warm.simulation().snapshot();
      since = 1;
    }
    warm.simulation().step();
    run.ResumeTiming();
    benchmark::DoNotOptimize(warm.simulation().snapshot(detail));
  }
}

/// Serialises it, and tells how many bytes that gives.
template <typename Message>
void serialise(const Message& message, benchmark::State& run) {
  const ros::SerializedMessage bytes = ros::serialization::serializeMessage(message);
  benchmark::DoNotOptimize(bytes.buf.get());
  run.counters["bytes"] = static_cast<double>(bytes.num_bytes);
}

void frame(benchmark::State& run) {
  Warm warm(scene(run), kWarmUp);
  const auto shot = warm.simulation().snapshot();
  ClothFrame message;
  for (auto _ : run) {
    fillFrame(*shot, std_msgs::Header(), message);
    serialise(message, run);
  }
}

void markers(benchmark::State& run) {
  Warm warm(scene(run), kWarmUp);
  const auto shot = warm.simulation().snapshot();
  MarkerBuilder builder{MarkerStyle()};
  for (auto _ : run) serialise(builder.build(*shot, *shot->figures, ros::Time(1.0)), run);
}

void sizes(benchmark::internal::Benchmark* message) {
  message->ArgName("side")->Arg(32)->Arg(128)->Arg(256)->Unit(benchmark::kMillisecond);
}

BENCHMARK_CAPTURE(snapshot, figures, Detail::kFigures)->Name("message/snapshot")->Apply(sizes);
BENCHMARK_CAPTURE(snapshot, shape, Detail::kShape)->Name("message/shape")->Apply(sizes);
BENCHMARK(frame)->Name("message/frame")->Apply(sizes);
BENCHMARK(markers)->Name("message/markers")->Apply(sizes);

}  // namespace
}  // namespace cloth_sim::bench
