// One piece of work that somebody asked for, and what belongs to it alone: how many threads it has,
// where its messages go, whether it shows progress. Two jobs may run in one process at the same
// time, each in a thread of its own.
#pragma once

#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_scheduler_observer.h>
#include <spdlog/common.h>

#include <filesystem>
#include <memory>
#include <mutex>
#include <type_traits>

namespace rigmap {

class Job {
 public:
  // Errors only on the terminal if `quiet`. Without a log file every message goes to the terminal.
  // `sharing`: how many jobs are at work in this process at the same time.
  Job(int threads, bool quiet, int sharing = 1);
  ~Job();
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  // Calls `work` as part of this job: in it, on whatever thread, Current() is this job, and TBB has
  // its threads and no more. What `work` throws comes through.
  template <class Work>
  auto Run(Work&& work) {
    return RunWithThreads(threads_, std::forward<Work>(work));
  }
  // The same with fewer threads, for work of which each thread needs much memory.
  template <class Work>
  auto RunWithThreads(int threads, Work&& work) {
    tbb::task_arena arena(std::min(threads, threads_));
    const Observer observer(arena, *this);
    return arena.execute(std::forward<Work>(work));
  }

  // From now on messages go to the end of the file at `path`; warnings and worse to the terminal as
  // well.
  void LogTo(const std::filesystem::path& path);
  // All messages go to the terminal again.
  void LogToTerminal();

  bool quiet() const { return quiet_; }
  int threads() const { return threads_; }
  int sharing() const { return sharing_; }

  // The job that the calling thread works for; nullptr if it works for none.
  static Job* Current();

 private:
  // Tells each thread of an arena whom it works for.
  class Observer : public tbb::task_scheduler_observer {
   public:
    Observer(tbb::task_arena& arena, Job& job);
    ~Observer() override { observe(false); }
    void on_scheduler_entry(bool is_worker) override;
    void on_scheduler_exit(bool is_worker) override;

   private:
    Job& job_;
  };
  friend class JobSink;

  int threads_;
  bool quiet_;
  int sharing_;
  std::mutex mutex_;
  spdlog::sink_ptr file_;  // nothing: the terminal
};

}  // namespace rigmap
