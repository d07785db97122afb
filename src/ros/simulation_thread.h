#pragma once
/// \file The thread that owns the simulation: commands go in, immutable observations come out.
/// Independent of ROS.

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <mutex>
#include <set>
#include <thread>

#include "clamp_jobs.h"
#include "cloth_sim/sim/simulation.h"
#include "observation_board.h"
#include "pace.h"
#include "run_job.h"
#include "speed_meter.h"

namespace cloth_sim {

/// Settings of a run.
struct RunSettings {
  double realTimeFactor = 1.0;  ///< simulated over wall time, >= 0; 0: as fast as possible
  bool paused = false;          ///< whether the run starts paused
  int threads = 0;              ///< number for the core's loops; 0: all that the machine has
  /// Called with the simulated time [s] after every step and whenever the time jumps, in order,
  /// from the thread that changed it; must not block.
  std::function<void(double)> onTime = nullptr;
  /// Called with each warning about a command that was carried out, once for each text until the
  /// cloth is reset, from the simulation thread; must not block.
  std::function<void(const std::string&)> onWarning = nullptr;
};

/// Answer to a request for steps.
struct StepResult {
  CommandResult result;
  std::uint64_t step = 0;  ///< steps since the start or the last reset
  double time = 0.0;       ///< [s]
};

/// Runs a `Simulation` in a thread of its own, at a set pace or as fast as possible. All methods
/// may be called from any thread; only `execute`, `inspect`, `observeWhole` and the future of
/// `requestSteps` wait for the simulation.
class SimulationThread {
 public:
  static constexpr std::size_t kMaxWaiting = 1000;  ///< commands that may wait
  static constexpr int kMaxSteps = 1000000;         ///< steps that one request may ask for

  using Answer = std::function<void(const CommandResult&)>;
  using Inspection = std::function<void(const Simulation&)>;

  /// \throws what the constructor of `Simulation` throws.
  SimulationThread(Scene scene, const RunSettings& settings);
  ~SimulationThread();
  SimulationThread(const SimulationThread&) = delete;
  SimulationThread& operator=(const SimulationThread&) = delete;

  /// Stops the thread, even within a step, and answers everybody who waits. Called by the
  /// destructor; may be called before.
  void stop();

  /// Queues a command, to be carried out between two steps.
  /// \param answer  called from the simulation thread with the result; must not block.
  void post(Command command, Answer answer = {});

  /// Queues a command and waits until it was carried out or refused. A command whose turn has not
  /// come within `timeout` is withdrawn.
  CommandResult execute(Command command, std::chrono::milliseconds timeout);

  /// Has `inspection` called between two steps, from the simulation thread, and waits for it.
  CommandResult inspect(Inspection inspection, std::chrono::milliseconds timeout);

  void setPaused(bool paused);

  /// Sets the pace from the next step on.
  /// \param factor  simulated over wall time, >= 0; 0: as fast as possible.
  void setRealTimeFactor(double factor);

  /// Pauses, and makes `steps` steps as fast as possible.
  std::future<StepResult> requestSteps(int steps);

  /// Runs until `goal` is met, then pauses. Ends a pause, and cancels the run before, if there is
  /// one. \return the number of the run; 0, and no answer comes, if the thread has stopped.
  std::uint64_t requestRun(RunGoal goal, RunJob::Answer answer);
  /// Cancels the run of that number and pauses, unless the run is over.
  void cancelRun(std::uint64_t number);

  /// Begins a goal of a clamp between two steps, or refuses it; its listener is told. It neither
  /// ends a pause nor pauses.
  void startJob(const std::shared_ptr<ClampJob>& job);
  /// Cancels a goal of a clamp, unless it is over.
  void cancelJob(const std::shared_ptr<ClampJob>& job);
  /// Cancels the goal for a part of a clamp, if there is one.
  void cancelJob(const std::string& clamp, ClampJob::Part part);

  /// Sets the rate of observations, in wall time [Hz], > 0. Others are made after commands that
  /// somebody waits for, after requested steps, and when the simulation has failed.
  void setObservationRate(double rate) { observationRate_ = rate; }
  /// Sets the rate of observations with figures [Hz], > 0. Those others always have figures.
  void setFigureRate(double rate) { figureRate_ = rate; }
  /// Sets whether observations have the contact points of layers of cloth. If they did not before,
  /// there is an observation that has them soon, also while paused.
  void setContactsWanted(bool wanted);

  /// Returns the latest observation; its snapshots are never null.
  Observation observe() const;
  /// Returns an observation of now with figures, or the latest if that takes longer than `timeout`.
  Observation observeWhole(std::chrono::milliseconds timeout);
  /// Waits until there is an observation newer than number `seen`, at most for `timeout`.
  void waitForObservation(std::uint64_t seen, std::chrono::duration<double> timeout) const {
    board_.waitFor(seen, timeout);
  }

  /// Returns the failures of springs since the last call or reset. For one caller only.
  FailureBatch takeEvents() { return board_.takeFailures(); }
  /// Returns the events of grips since the last call. For one caller only.
  std::vector<GripEvent> takeGripEvents() { return board_.takeGripEvents(); }

  /// Returns the commands that were carried out since the last call. For one caller only.
  std::vector<CommandRecord> takeCommands() { return board_.takeCommands(); }

 private:
  using Clock = std::chrono::steady_clock;

  /// A goal to begin or to cancel, or a part of a clamp whose goal is cancelled.
  struct JobRequest {
    std::shared_ptr<ClampJob> job;  ///< null: that for the part of the clamp, whichever it is
    bool begins = false;
    std::string clamp;
    ClampJob::Part part = ClampJob::Part::kMotion;
  };

  using Work = std::variant<Command, Inspection, JobRequest>;

  /// A request that waits for its turn.
  struct Envelope {
    Work request;
    Answer answer;
    std::shared_ptr<std::atomic<bool>>
        withdrawn;  ///< set when nobody waits any more; null: nobody does
  };
  struct StepJob {
    int left = 0;
    std::promise<StepResult> promise;
  };
  struct NumberedRun {
    std::uint64_t number = 0;
    RunJob job;
  };

  bool enqueue(Envelope envelope);
  CommandResult deliver(Work request, std::chrono::milliseconds timeout);
  void run();
  void takeRequests();
  void takeMail(bool last);
  void takeRuns(bool last);
  void endRun(RunResult::Outcome outcome, const std::string& message);
  void process(Envelope& envelope);
  void processJob(const JobRequest& request);
  CommandResult applyCommand(const Command& command);
  CommandResult carryOut(const Command& command);
  void warnOnce(const std::string& warning);
  void beginAnew();
  bool mayStep() const;
  bool isEarly() const;
  void stepOnce();
  void checkRun();
  void tellTime();
  void collectEvents();
  void countJobStep();
  void answerJobs(const CommandResult& result);
  void waitForWork();
  void keepPace(Clock::time_point now);
  void waitForPace();
  void show();
  void publish(Detail detail = Detail::kFigures);
  bool hasRequests() const;

  // Used by the simulation thread only.
  Simulation simulation_;
  RunSettings settings_;
  std::deque<StepJob> jobs_;
  std::optional<NumberedRun> run_;
  ClampJobs clampJobs_{simulation_, [this](const Command& command) { return carryOut(command); }};
  std::set<std::string> warned_;  ///< texts that onWarning got since the last reset
  std::deque<Envelope> taken_;
  Clock::time_point nextStep_;
  Pace observationPace_;
  Pace figurePace_;
  SpeedMeter meter_;
  std::uint64_t resets_ = 0;
  bool failureShown_ = false;
  bool unseen_ = false;  ///< whether a step has been made since the last observation

  StopFlag stopsStep_{false};  ///< ends the step under way
  std::atomic<double> observationRate_{30.0};
  std::atomic<double> figureRate_{30.0};
  std::atomic<bool> contactsWanted_{false};
  std::atomic<double> realTimeFactorAsked_;

  mutable std::mutex requestMutex_;
  std::condition_variable requestsArrived_;
  std::deque<Envelope> mailbox_;
  std::deque<StepJob> newJobs_;
  std::deque<NumberedRun> newRuns_;
  std::vector<std::uint64_t> cancelledRuns_;
  std::uint64_t runs_ = 0;  ///< number of runs requested so far
  bool paused_ = false;
  bool stopping_ = false;
  bool paceChanged_ = false;
  std::uint64_t dropped_ = 0;

  ObservationBoard board_;

  std::thread thread_;  // last: starts when everything above is there
};

}  // namespace cloth_sim
