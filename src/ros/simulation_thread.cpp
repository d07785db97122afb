#include "simulation_thread.h"

#include <algorithm>
#include <utility>

#include "cloth_sim/threads/thread_limit.h"
#include "support/cpu_clock.h"
#include "thread_name.h"

namespace cloth_sim {
namespace {

using std::chrono::duration;
using std::chrono::duration_cast;

constexpr double kMaxLag = 0.1;  ///< a longer delay behind the pace is not made up for [s]

std::string failureMessage(const Simulation& simulation) {
  return "the simulation has failed (" + simulation.failure() + "); reset it";
}

}  // namespace

SimulationThread::SimulationThread(Scene scene, const RunSettings& settings)
    : simulation_(std::move(scene)),
      settings_(settings),
      realTimeFactorAsked_(settings.realTimeFactor),
      paused_(settings.paused) {
  simulation_.stopWhen(stopsStep_);
  publish();
  tellTime();
  meter_.restart(simulation_.time());
  thread_ = std::thread([this] { run(); });
}

SimulationThread::~SimulationThread() { stop(); }

void SimulationThread::stop() {
  {
    const std::lock_guard<std::mutex> lock(requestMutex_);
    stopping_ = true;
  }
  stopsStep_ = true;
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
  return deliver(std::move(command), timeout);
}

CommandResult SimulationThread::inspect(Inspection inspection, std::chrono::milliseconds timeout) {
  return deliver(std::move(inspection), timeout);
}

CommandResult SimulationThread::deliver(Work request, std::chrono::milliseconds timeout) {
  const auto promise = std::make_shared<std::promise<CommandResult>>();
  const auto withdrawn = std::make_shared<std::atomic<bool>>(false);
  std::future<CommandResult> future = promise->get_future();
  const Answer answer = [promise](const CommandResult& result) { promise->set_value(result); };
  if (!enqueue({std::move(request), answer, withdrawn})) {
    return {false, "too many commands are waiting, or the node is shutting down"};
  }
  if (future.wait_for(timeout) == std::future_status::ready) return future.get();
  // The thread that sets the flag first, this one or the simulation's, decides.
  if (withdrawn->exchange(true)) return future.get();
  return {false, "no answer from the simulation in time; the command was withdrawn"};
}

void SimulationThread::startJob(const std::shared_ptr<ClampJob>& job) {
  if (enqueue({JobRequest{job, true, "", job->part()}, nullptr, nullptr})) return;
  ClampJobs::refuse(*job, "too many commands are waiting, or the node is shutting down");
}

void SimulationThread::cancelJob(const std::shared_ptr<ClampJob>& job) {
  enqueue({JobRequest{job, false, "", job->part()}, nullptr, nullptr});
}

void SimulationThread::cancelJob(const std::string& clamp, ClampJob::Part part) {
  enqueue({JobRequest{nullptr, false, clamp, part}, nullptr, nullptr});
}

void SimulationThread::setPaused(bool paused) {
  {
    const std::lock_guard<std::mutex> lock(requestMutex_);
    paused_ = paused;
  }
  requestsArrived_.notify_all();
}

void SimulationThread::setRealTimeFactor(double factor) {
  {
    const std::lock_guard<std::mutex> lock(requestMutex_);
    realTimeFactorAsked_ = factor;
    paceChanged_ = true;
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

std::uint64_t SimulationThread::requestRun(RunGoal goal, RunJob::Answer answer) {
  std::uint64_t number = 0;
  {
    const std::lock_guard<std::mutex> lock(requestMutex_);
    if (stopping_) return 0;
    number = ++runs_;
    newRuns_.push_back({number, RunJob(std::move(goal), std::move(answer))});
    paused_ = false;
  }
  requestsArrived_.notify_all();
  return number;
}

void SimulationThread::cancelRun(std::uint64_t number) {
  {
    const std::lock_guard<std::mutex> lock(requestMutex_);
    cancelledRuns_.push_back(number);
  }
  requestsArrived_.notify_all();
}

void SimulationThread::setContactsWanted(bool wanted) {
  if (contactsWanted_.exchange(wanted) || !wanted) return;
  // A request publishes an observation if no step does it soon.
  enqueue({Inspection([](const Simulation& /*simulation*/) {}), nullptr, nullptr});
}

Observation SimulationThread::observe() const {
  Observation result = board_.latest();
  const std::lock_guard<std::mutex> lock(requestMutex_);
  result.paused = paused_;
  result.realTimeFactorAsked = realTimeFactorAsked_;
  result.droppedCommands = dropped_;
  return result;
}

Observation SimulationThread::observeWhole(std::chrono::milliseconds timeout) {
  inspect([](const Simulation& /*simulation*/) {},
          timeout);  // a request that somebody waits for publishes figures
  return observe();
}

void SimulationThread::run() {
  nameThisThread("cloth_step");
  const ThreadLimit limit(settings_.threads);
  nextStep_ = Clock::now();
  while (true) {
    takeRequests();
    {
      const std::lock_guard<std::mutex> lock(requestMutex_);
      if (stopping_) break;
    }
    if (!mayStep()) {
      waitForWork();
    } else if (isEarly()) {
      waitForPace();
    } else {
      stepOnce();
    }
  }
  takeRequests();
  clampJobs_.endAll("the node is shutting down");
  answerJobs({false, "the node is shutting down"});
}

void SimulationThread::takeRequests() {
  bool last = false;
  {
    const std::lock_guard<std::mutex> lock(requestMutex_);
    std::swap(taken_, mailbox_);
    for (StepJob& job : newJobs_) jobs_.push_back(std::move(job));
    newJobs_.clear();
    last = stopping_;
    if (std::exchange(paceChanged_, false)) nextStep_ = Clock::now();
  }
  takeMail(last);
  takeRuns(last);
}

/// Processes the requests without holding the lock of the mailbox.
/// \param last  whether the thread is stopping: then they are refused.
void SimulationThread::takeMail(bool last) {
  bool show = !taken_.empty() && !last;
  for (Envelope& envelope : taken_) {
    if (!last) {
      process(envelope);
    } else if (const auto* job = std::get_if<JobRequest>(&envelope.request)) {
      if (job->begins) ClampJobs::refuse(*job->job, "the node is shutting down");
    } else if (envelope.answer && !(envelope.withdrawn && envelope.withdrawn->exchange(true))) {
      envelope.answer({false, "the node is shutting down"});
    }
  }
  if (show) clampJobs_.tend();  // a command may have ended a goal, and a goal may be met already
  taken_.clear();
  show = show && !mayStep();  // otherwise the next step's observation comes soon enough
  if (show) publish();
}

void SimulationThread::takeRuns(bool last) {
  std::deque<NumberedRun> fresh;
  std::vector<std::uint64_t> cancelled;
  {
    const std::lock_guard<std::mutex> lock(requestMutex_);
    std::swap(fresh, newRuns_);
    std::swap(cancelled, cancelledRuns_);
  }
  for (NumberedRun& next : fresh) {
    endRun(RunResult::Outcome::kCancelled, "another run took its place");
    run_ = std::move(next);
    run_->job.begin(simulation_);
    checkRun();
  }
  for (const std::uint64_t number : cancelled) {
    if (!run_ || run_->number != number) continue;
    setPaused(true);
    endRun(RunResult::Outcome::kCancelled, "cancelled");
  }
  if (last) endRun(RunResult::Outcome::kFailed, "the node is shutting down");
}

void SimulationThread::endRun(RunResult::Outcome outcome, const std::string& message) {
  if (!run_) return;
  publish();
  run_->job.finish(outcome, message, simulation_);
  run_.reset();
}

/// Ends the current run if its goal is met or out of reach, and pauses.
void SimulationThread::checkRun() {
  if (!run_ || !run_->job.isOver(simulation_)) return;
  setPaused(true);
  publish();
  run_->job.answer(simulation_);
  run_.reset();
}

void SimulationThread::process(Envelope& envelope) {
  if (envelope.withdrawn && envelope.withdrawn->exchange(true)) return;
  CommandResult result{true, ""};
  if (const auto* inspection = std::get_if<Inspection>(&envelope.request)) {
    (*inspection)(simulation_);
  } else if (const auto* job = std::get_if<JobRequest>(&envelope.request)) {
    processJob(*job);
  } else {
    result = applyCommand(std::get<Command>(envelope.request));
  }
  if (envelope.withdrawn) publish();  // so that the caller sees the effect when the answer comes
  if (envelope.answer) envelope.answer(result);
}

void SimulationThread::processJob(const JobRequest& request) {
  if (request.begins) {
    clampJobs_.start(request.job);
  } else if (request.job) {
    clampJobs_.cancel(request.job.get());
  } else {
    clampJobs_.cancel(request.clamp, request.part);
  }
}

/// Carries out a command of a client.
CommandResult SimulationThread::applyCommand(const Command& command) {
  const CommandResult result = carryOut(command);
  if (!result.success) return result;
  if (replacesCloth(command)) beginAnew();
  if (changesTime(command)) {
    clampJobs_.endAll("the simulated time was set");
    meter_.restart(simulation_.time());
    figurePace_ = Pace();
    tellTime();
  }
  collectEvents();
  return result;
}

/// Carries out a command, and records it.
CommandResult SimulationThread::carryOut(const Command& command) {
  CommandRecord record{0, simulation_.stepCount(), simulation_.time(), command};
  const CommandResult result = simulation_.apply(command);
  if (!result.success) return result;
  board_.addCommand(std::move(record));
  if (!result.warning.empty()) warnOnce(result.warning);
  return result;
}

void SimulationThread::warnOnce(const std::string& warning) {
  constexpr std::size_t kMaxWarnings = 1000;  // clamps may be added without end
  if (!settings_.onWarning || warned_.size() >= kMaxWarnings) return;
  if (warned_.insert(warning).second) settings_.onWarning(warning);
}

/// Forgets what belongs to the cloth before, after a reset or a restored state.
void SimulationThread::beginAnew() {
  endRun(RunResult::Outcome::kFailed, "the simulation was reset");
  clampJobs_.endAll("the simulation was reset");
  warned_.clear();
  ++resets_;
  failureShown_ = false;
  const std::vector<FailureEvent> pending = simulation_.takeEvents();
  const auto& all = simulation_.failures();
  const auto told = all.end() - static_cast<std::ptrdiff_t>(pending.size());
  board_.replaceFailures({resets_, {all.begin(), told}, pending});
}

bool SimulationThread::mayStep() const {
  if (simulation_.failed()) return false;
  if (!jobs_.empty()) return true;
  const std::lock_guard<std::mutex> lock(requestMutex_);
  return !paused_;
}

bool SimulationThread::isEarly() const { return jobs_.empty() && Clock::now() < nextStep_; }

void SimulationThread::stepOnce() {
  const Clock::time_point start = Clock::now();
  if (jobs_.empty()) keepPace(start);
  const double cpuStart = threadCpuTime();
  simulation_.step();
  if (stopsStep_) return;
  meter_.addStep(simulation_.time(), Clock::now() - start, threadCpuTime() - cpuStart);
  unseen_ = true;
  tellTime();
  collectEvents();
  clampJobs_.tend();
  if (const double rate = observationRate_; observationPace_.isDue(Clock::now(), rate)) {
    observationPace_.take(Clock::now(), rate);
    show();
  }
  countJobStep();
  checkRun();
}

void SimulationThread::tellTime() {
  if (settings_.onTime) settings_.onTime(simulation_.time());
}

/// Takes over the events of steps, and of commands that cut.
void SimulationThread::collectEvents() {
  board_.addEvents(simulation_.takeEvents(), simulation_.takeGripEvents());
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

/// Sleeps while paused or failed, until a request comes.
void SimulationThread::waitForWork() {
  if (simulation_.failed()) {
    answerJobs({false, failureMessage(simulation_)});
    if (!std::exchange(failureShown_, true)) publish();
  } else if (meter_.isMeasuring()) {  // it has just paused
    meter_.stop();
    publish();
  }
  std::unique_lock<std::mutex> lock(requestMutex_);
  const bool failed = simulation_.failed();
  requestsArrived_.wait(lock, [&] { return hasRequests() || (!paused_ && !failed); });
  lock.unlock();
  nextStep_ = Clock::now();
  meter_.restart(simulation_.time());
}

bool SimulationThread::hasRequests() const {
  return stopping_ || paceChanged_ || !mailbox_.empty() || !newJobs_.empty() || !newRuns_.empty() ||
         !cancelledRuns_.empty();
}

/// Computes when the step after the one that begins now is due.
void SimulationThread::keepPace(Clock::time_point now) {
  const double factor = realTimeFactorAsked_;
  if (factor <= 0.0) {
    nextStep_ = now;
    return;
  }
  const auto maxLag = duration_cast<Clock::duration>(duration<double>(kMaxLag));
  nextStep_ = std::max(nextStep_, now - maxLag);
  const double period = simulation_.scene().solver.dt / factor;
  nextStep_ += duration_cast<Clock::duration>(duration<double>(period));
}

void SimulationThread::waitForPace() {
  const double wait = duration<double>(nextStep_ - Clock::now()).count();
  if (unseen_ && wait * observationRate_ > 1.0) show();
  std::unique_lock<std::mutex> lock(requestMutex_);
  requestsArrived_.wait_until(lock, nextStep_, [&] { return hasRequests() || paused_; });
}

/// Publishes an observation while it runs, with figures at their own rate.
void SimulationThread::show() {
  const Clock::time_point now = Clock::now();
  const double rate = figureRate_;
  const bool due = figurePace_.isDue(now, rate);
  if (due) figurePace_.take(now, rate);
  publish(due ? Detail::kFigures : Detail::kShape);
}

void SimulationThread::publish(Detail detail) {
  unseen_ = false;
  Observation observation;
  const bool points = contactsWanted_;
  observation.snapshot =
      simulation_.snapshot(detail, points ? ContactDetail::kPoints : ContactDetail::kReport);
  if (detail == Detail::kFigures) observation.whole = observation.snapshot;
  observation.phases = simulation_.script().history();
  observation.realTimeFactor = meter_.realTimeFactor();
  observation.stepTime = meter_.stepTime();
  observation.stepCpuTime = meter_.cpuTime();
  observation.substep = simulation_.substep();
  observation.resets = resets_;
  board_.show(std::move(observation));
}

}  // namespace cloth_sim
