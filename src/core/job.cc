#include "core/job.h"

#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <vector>

namespace rigmap {
namespace {

// The jobs that this thread has entered and not left, the innermost last.
thread_local std::vector<Job*> entered_jobs;

}  // namespace

// Hands each message to the job that its thread works for.
class JobSink : public spdlog::sinks::base_sink<std::mutex> {
 public:
  JobSink() { terminal_.set_pattern("rigmap: %v"); }

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    Job* job = Job::Current();
    spdlog::sink_ptr file;
    if (job) {
      const std::lock_guard lock(job->mutex_);
      file = job->file_;
    }
    if (file) file->log(message);
    const auto shown = job && job->quiet() ? spdlog::level::err
                       : file              ? spdlog::level::warn
                                           : spdlog::level::info;
    if (message.level >= shown) terminal_.log(message);
  }
  void flush_() override {
    if (Job* job = Job::Current()) {
      const std::lock_guard lock(job->mutex_);
      if (job->file_) job->file_->flush();
    }
  }
  void set_pattern_(const std::string&) override {}
  void set_formatter_(std::unique_ptr<spdlog::formatter>) override {}

 private:
  spdlog::sinks::stderr_sink_mt terminal_;
};

namespace {

void InstallLogger() {
  static std::once_flag once;
  std::call_once(once, [] {
    auto logger = std::make_shared<spdlog::logger>("rigmap", std::make_shared<JobSink>());
    logger->flush_on(spdlog::level::info);
    spdlog::set_default_logger(std::move(logger));
  });
}

}  // namespace

Job::Job(int threads, bool quiet, int sharing)
    : threads_(threads), quiet_(quiet), sharing_(sharing) {
  InstallLogger();
}

Job::~Job() = default;

void Job::LogTo(const std::filesystem::path& path) {
  auto file = std::make_shared<spdlog::sinks::basic_file_sink_mt>(path.string(), false);
  const std::lock_guard lock(mutex_);
  file_ = std::move(file);
}

void Job::LogToTerminal() {
  const std::lock_guard lock(mutex_);
  file_.reset();
}

Job* Job::Current() { return entered_jobs.empty() ? nullptr : entered_jobs.back(); }

Job::Observer::Observer(tbb::task_arena& arena, Job& job)
    : tbb::task_scheduler_observer(arena), job_(job) {
  observe(true);
}

void Job::Observer::on_scheduler_entry(bool) { entered_jobs.push_back(&job_); }

void Job::Observer::on_scheduler_exit(bool) { entered_jobs.pop_back(); }

}  // namespace rigmap
