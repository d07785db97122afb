#include "cloth_sim/ros/simulation_thread.h"

#include <algorithm>
#include <utility>

#include "cloth_sim/sim/parallel.h"

namespace cloth_sim {
namespace {

using std::chrono::duration;
using std::chrono::duration_cast;

constexpr double kMeasuringWindow = 0.5;  ///< [s]
constexpr double kMaxLag = 0.1;  ///< behind the pace by more than this, the lag is forgiven [s]

int threadCount(int asked) {
  return asked > 0 ? asked : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

std::string failureMessage(const Simulation& simulation) {
  return "the simulation has failed (" + simulation.failure() + "); reset it";
}

}  // namespace

SimulationThread::SimulationThread(Scene scene, const RunSettings& settings)
    : simulation_(std::move(scene)), settings_(settings), paused_(settings.paused) {
  publish();
  startMeasuring();
  thread_ = std::thread([this] { run(threadCount(settings_.threads)); });
}

SimulationThread::~SimulationThread() { stop(); }

void SimulationThread::stop() {
  {
    const std::lock_guard<std::mutex> lock(requestMutex_);
    stopping_ = true;
  }
  requestsArrived_.notify_all();
  if (thread_.joinable()) thread_.join();
}

bool SimulationThread::enqueue(Envelope envelope) {
  {
    const std::lock_guard<std::mutex> lock(requestMutex_);
    if (stopping_) return false;
    if (mailbox_.size() >= kMaxWaiting) {
      ++dropped_;
      return false;
    }
    mailbox_.push_back(std::move(envelope));
  }
  requestsArrived_.notify_all();
  return true;
}

void SimulationThread::post(Command command, Answer answer) {
  Answer copy = answer;
  if (!enqueue({std::move(command), std::move(answer), nullptr}) && copy) {
    copy({false, "too many commands are waiting"});
  }
}

CommandResult SimulationThread::execute(Command command, std::chrono::milliseconds timeout) {
  const auto promise = std::make_shared<std::promise<CommandResult>>();
  const auto withdrawn = std::make_shared<std::atomic<bool>>(false);
  std::future<CommandResult> future = promise->get_future();
  const Answer answer = [promise](const CommandResult& result) { promise->set_value(result); };
  if (!enqueue({std::move(command), answer, withdrawn})) {
    return {false, "too many commands are waiting, or the node is shutting down"};
  }
  if (future.wait_for(timeout) == std::future_status::ready) return future.get();
  // Whoever sets the flag first, this thread or the simulation's, decides.
  if (withdrawn->exchange(true)) return future.get();
  return {false, "no answer from the simulation in time; the command was withdrawn"};
}

void SimulationThread::setPaused(bool paused) {
  {
    const std::lock_guard<std::mutex> lock(requestMutex_);
    paused_ = paused;
  }
  requestsArrived_.notify_all();
}

std::future<StepResult> SimulationThread::requestSteps(int steps) {
  StepJob job;
  job.left = steps;
  std::future<StepResult> future = job.promise.get_future();
  {
    const std::lock_guard<std::mutex> lock(requestMutex_);
    if (stopping_) {
      job.promise.set_value({{false, "the node is shutting down"}, 0, 0.0});
      return future;
    }
    paused_ = true;
    newJobs_.push_back(std::move(job));
  }
  requestsArrived_.notify_all();
  return future;
}

Observation SimulationThread::observe() const {
  Observation result;
  {
    const std::lock_guard<std::mutex> lock(outputMutex_);
    result = observation_;
  }
  const std::lock_guard<std::mutex> lock(requestMutex_);
  result.paused = paused_;
  result.droppedCommands = dropped_;
  return result;
}

FailureBatch SimulationThread::takeEvents() {
  const std::lock_guard<std::mutex> lock(outputMutex_);
  return {failures_.resets, std::exchange(failures_.events, {})};
}

std::vector<GripEvent> SimulationThread::takeGripEvents() {
  const std::lock_guard<std::mutex> lock(outputMutex_);
  return std::exchange(gripEvents_, {});
}

void SimulationThread::run(int threads) {
  const ThreadLimit limit(threads);
  nextStep_ = Clock::now();
  while (true) {
    takeRequests();
    {
      const std::lock_guard<std::mutex> lock(requestMutex_);
      if (stopping_) break;
    }
    if (mayStep()) {
      stepOnce();
      if (jobs_.empty()) waitForPace();
    } else {
      waitForWork();
    }
  }
  takeRequests();
  answerJobs({false, "the node is shutting down"});
}

/// Empties the mailbox, so that commands are carried out without holding its lock.
void SimulationThread::takeRequests() {
  bool last = false;
  {
    const std::lock_guard<std::mutex> lock(requestMutex_);
    std::swap(taken_, mailbox_);
    for (StepJob& job : newJobs_) jobs_.push_back(std::move(job));
    newJobs_.clear();
    last = stopping_;
  }
  bool show = !taken_.empty() && !last;
  for (Envelope& envelope : taken_) {
    if (!last) {
      carryOut(envelope);
    } else if (envelope.answer && !(envelope.withdrawn && envelope.withdrawn->exchange(true))) {
      envelope.answer({false, "the node is shutting down"});
    }
  }
  taken_.clear();
  show = show && !mayStep();  // otherwise the next step's observation comes soon enough
  if (show) publish();
}

void SimulationThread::carryOut(Envelope& envelope) {
  if (envelope.withdrawn && envelope.withdrawn->exchange(true)) return;
  const CommandResult result = simulation_.apply(envelope.command);
  if (result.success && std::holds_alternative<Reset>(envelope.command)) {
    ++resets_;
    failureShown_ = false;
    simulation_.takeEvents();
    {
      const std::lock_guard<std::mutex> lock(outputMutex_);
      failures_ = {resets_, {}};
    }
    startMeasuring();
  }
  collectEvents();
  if (envelope.withdrawn) publish();  // who waits for the answer shall see its effect
  if (envelope.answer) envelope.answer(result);
}

bool SimulationThread::mayStep() const {
  if (simulation_.failed()) return false;
  if (!jobs_.empty()) return true;
  const std::lock_guard<std::mutex> lock(requestMutex_);
  return !paused_;
}

void SimulationThread::stepOnce() {
  const Clock::time_point start = Clock::now();
  simulation_.step();
  collectEvents();
  measure(Clock::now() - start);
  const double sinceLast = duration<double>(Clock::now() - lastObservation_).count();
  if (sinceLast * observationRate_ >= 1.0) publish();
  countJobStep();
}

/// Springs fail in steps, and by commands that cut.
void SimulationThread::collectEvents() {
  const std::vector<FailureEvent> events = simulation_.takeEvents();
  const std::vector<GripEvent> grips = simulation_.takeGripEvents();
  if (events.empty() && grips.empty()) return;
  const std::lock_guard<std::mutex> lock(outputMutex_);
  failures_.events.insert(failures_.events.end(), events.begin(), events.end());
  gripEvents_.insert(gripEvents_.end(), grips.begin(), grips.end());
}

void SimulationThread::countJobStep() {
  if (jobs_.empty() || simulation_.failed()) return;
  StepJob& job = jobs_.front();
  if (--job.left > 0) return;
  publish();
  job.promise.set_value({{true, "done"}, simulation_.stepCount(), simulation_.time()});
  jobs_.pop_front();
}

void SimulationThread::answerJobs(const CommandResult& result) {
  for (StepJob& job : jobs_) {
    job.promise.set_value({result, simulation_.stepCount(), simulation_.time()});
  }
  jobs_.clear();
}

/// Paused or failed: sleeps until someone asks for something.
void SimulationThread::waitForWork() {
  if (simulation_.failed()) {
    answerJobs({false, failureMessage(simulation_)});
    if (!std::exchange(failureShown_, true)) publish();
  } else if (windowSteps_ > 0) {  // just paused: show where it stands
    realTimeFactor_ = 0.0;
    publish();
  }
  std::unique_lock<std::mutex> lock(requestMutex_);
  const bool failed = simulation_.failed();
  requestsArrived_.wait(lock, [&] { return hasRequests() || (!paused_ && !failed); });
  lock.unlock();
  nextStep_ = Clock::now();
  startMeasuring();
}

bool SimulationThread::hasRequests() const {
  return stopping_ || !mailbox_.empty() || !newJobs_.empty();
}

void SimulationThread::waitForPace() {
  if (settings_.realTimeFactor <= 0.0) return;
  const double period = simulation_.scene().solver.dt / settings_.realTimeFactor;
  nextStep_ += duration_cast<Clock::duration>(duration<double>(period));
  const auto maxLag = duration_cast<Clock::duration>(duration<double>(kMaxLag));
  nextStep_ = std::max(nextStep_, Clock::now() - maxLag);
  // Commands that arrive meanwhile wait for the next step at most; they need not wake it up.
  std::unique_lock<std::mutex> lock(requestMutex_);
  requestsArrived_.wait_until(lock, nextStep_, [&] { return stopping_ || paused_; });
}

void SimulationThread::startMeasuring() {
  windowStart_ = Clock::now();
  windowBusy_ = {};
  windowTime_ = simulation_.time();
  windowSteps_ = 0;
}

void SimulationThread::measure(Clock::duration busy) {
  windowBusy_ += busy;
  ++windowSteps_;
  const double wall = duration<double>(Clock::now() - windowStart_).count();
  if (wall < kMeasuringWindow) return;
  realTimeFactor_ = (simulation_.time() - windowTime_) / wall;
  stepTime_ = duration<double>(windowBusy_).count() / windowSteps_;
  startMeasuring();
}

void SimulationThread::publish() {
  std::shared_ptr<const Snapshot> snapshot = simulation_.snapshot();
  lastObservation_ = Clock::now();
  const std::lock_guard<std::mutex> lock(outputMutex_);
  observation_.snapshot = std::move(snapshot);
  observation_.phases = simulation_.script().history();
  observation_.realTimeFactor = realTimeFactor_;
  observation_.stepTime = stepTime_;
  observation_.substep = simulation_.substep();
  observation_.resets = resets_;
  ++observation_.number;
}

}  // namespace cloth_sim
