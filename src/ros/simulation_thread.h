#pragma once
/// \file The thread that owns the simulation: commands go in, immutable observations come out.
/// No ROS in here.

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <mutex>
#include <thread>

#include "cloth_sim/ros/observation.h"
#include "cloth_sim/sim/simulation.h"
#include "pace.h"
#include "run_job.h"

namespace cloth_sim {

/// How a simulation is run.
struct RunSettings {
  double realTimeFactor = 1.0;  ///< simulated over wall time, >= 0; 0: as fast as it can
  bool paused = false;          ///< at the start
  int threads = 0;              ///< of the core's loops; 0: as many as the machine has
  /// Told the simulated time [s] after every step and whenever it jumps, in order, from the thread
  /// that made it so; must not block.
  std::function<void(double)> onTime = nullptr;
};

/// The answer to a request for steps.
struct StepResult {
  CommandResult result;
  std::uint64_t step = 0;  ///< steps since the start or the last reset
  double time = 0.0;       ///< [s]
};

/// Runs a `Simulation` in a thread of its own, at a set pace or as fast as it can. All its methods
/// may be called from any thread; none waits for a step except `execute` and the future of
/// `requestSteps`.
class SimulationThread {
 public:
  static constexpr std::size_t kMaxWaiting = 1000;  ///< commands in the mailbox
  static constexpr int kMaxSteps = 1000000;         ///< of one request

  using Answer = std::function<void(const CommandResult&)>;
  using Look = std::function<void(const Simulation&)>;

  /// \throws what the constructor of `Simulation` throws.
  SimulationThread(Scene scene, const RunSettings& settings);
  ~SimulationThread();
  SimulationThread(const SimulationThread&) = delete;
  SimulationThread& operator=(const SimulationThread&) = delete;

  /// Stops the thread after the step it is in. Whoever waits gets an answer. Called by the
  /// destructor; may be called before.
  void stop();

  /// Puts a command into the mailbox; it is carried out between two steps.
  /// \param answer  called from the simulation thread with the result; must not block.
  void post(Command command, Answer answer = {});

  /// Posts a command and waits until it was carried out or refused. A command that was not taken
  /// up within `timeout` is withdrawn.
  CommandResult execute(Command command, std::chrono::milliseconds timeout);

  /// Has `look` called between two steps, from the simulation thread, and waits for it.
  CommandResult inspect(Look look, std::chrono::milliseconds timeout);

  void setPaused(bool paused);

  /// From the next step on. \param factor  simulated over wall time, >= 0; 0: as fast as it can.
  void setRealTimeFactor(double factor);

  /// Pauses, and makes `steps` steps as fast as it can.
  std::future<StepResult> requestSteps(int steps);

  /// Goes on, if it is paused, until `goal` is met, and pauses then. The run before it, if there is
  /// one, is cancelled. \return its number; 0, and no answer comes, if the thread has stopped.
  std::uint64_t requestRun(RunGoal goal, RunJob::Answer answer);
  /// Cancels the run of that number, unless it is over, and pauses.
  void cancelRun(std::uint64_t number);

  /// How often observations are wanted, in wall time [Hz], > 0. They are also made after commands
  /// that somebody waits for, after requested steps, and when the simulation has failed.
  void setObservationRate(double rate) { observationRate_ = rate; }
  /// How often they are to have figures [Hz], > 0: those that are also made have them anyway.
  void setFigureRate(double rate) { figureRate_ = rate; }

  /// The latest; its snapshots are never null.
  Observation observe() const;
  /// The same with figures of now, unless that takes longer than `timeout`.
  Observation observeWhole(std::chrono::milliseconds timeout);
  /// Waits until there is one after the one of number `seen`, but not longer than `timeout`.
  void waitForObservation(std::uint64_t seen, std::chrono::duration<double> timeout) const;

  /// Springs that failed since the last call and the last reset. One caller only.
  FailureBatch takeEvents();
  /// What became of grasps since the last call. One caller only.
  std::vector<GripEvent> takeGripEvents();

  /// Commands that were carried out since the last call. One caller only.
  std::vector<CommandRecord> takeCommands();

 private:
  using Clock = std::chrono::steady_clock;

  struct Envelope {
    std::variant<Command, Look> request;
    Answer answer;
    std::shared_ptr<std::atomic<bool>> withdrawn;  ///< null: cannot be
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
  CommandResult deliver(std::variant<Command, Look> request, std::chrono::milliseconds timeout);
  void run();
  void takeRequests();
  void takeMail(bool last);
  void takeRuns(bool last);
  void endRun(RunResult::Outcome outcome, const std::string& message);
  void carryOut(Envelope& envelope);
  CommandResult carryOut(const Command& command);
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
  void measure(Clock::duration busy);
  void startMeasuring();
  void show();
  void publish(Detail detail = Detail::kFigures);
  bool hasRequests() const;

  // Used by the simulation thread only.
  Simulation simulation_;
  RunSettings settings_;
  std::deque<StepJob> jobs_;
  std::optional<NumberedRun> run_;
  std::deque<Envelope> taken_;
  Clock::time_point nextStep_;
  Pace observationPace_;
  Pace figurePace_;
  Clock::time_point windowStart_;
  Clock::duration windowBusy_{};
  double windowTime_ = 0.0;  ///< simulated time of the start of the window [s]
  int windowSteps_ = 0;
  double realTimeFactor_ = 0.0;
  double stepTime_ = 0.0;
  double stepCpuTime_ = 0.0;
  std::uint64_t resets_ = 0;
  bool failureShown_ = false;
  bool unseen_ = false;  ///< a step has been made since the last observation

  std::atomic<double> observationRate_{30.0};
  std::atomic<double> figureRate_{30.0};
  std::atomic<double> realTimeFactorAsked_;

  mutable std::mutex requestMutex_;
  std::condition_variable requestsArrived_;
  std::deque<Envelope> mailbox_;
  std::deque<StepJob> newJobs_;
  std::deque<NumberedRun> newRuns_;
  std::vector<std::uint64_t> cancelledRuns_;
  std::uint64_t runs_ = 0;  ///< asked for
  bool paused_ = false;
  bool stopping_ = false;
  bool paceChanged_ = false;
  std::uint64_t dropped_ = 0;

  mutable std::mutex outputMutex_;
  mutable std::condition_variable observed_;
  Observation observation_;
  FailureBatch failures_;
  std::vector<CommandRecord> commands_;
  std::uint64_t commandCount_ = 0;
  std::vector<GripEvent> gripEvents_;

  std::thread thread_;  // last: starts when everything above is there
};

}  // namespace cloth_sim
