// ServerProcess: the real arapd in a process of its own, to be stopped, starved and killed.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <sys/types.h>

namespace arap::fault {

// A fresh directory, removed with everything in it by the destructor.
class TempFolder {
 public:
  TempFolder();
  ~TempFolder();
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  const std::string& path() const { return path_; }
  std::string operator/(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

// A child process with its output: the base of the server and of clients that are to be stopped.
// Dies with the thread that started it. For one thread.
class ChildProcess {
 public:
  ChildProcess() = default;
  ~ChildProcess();  // kills it
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  // Runs `words` with standard error added to the file `error_path`. False with a failure of the
  // test when it cannot be started. Nothing may be running.
  bool Launch(const std::vector<std::string>& words, const std::string& error_path);

  // The next line of standard output that begins with `prefix`, without the prefix; the lines
  // before it are skipped. Nothing when the process ends or `timeout` passes before.
  std::optional<std::string> ReadLine(const std::string& prefix, std::chrono::milliseconds timeout);

  void Signal(int signal) const;
  // The exit code, 128 + n for the end by signal n; nothing when it still runs after `timeout`.
  std::optional<int> Wait(std::chrono::milliseconds timeout);
  // SIGKILL, and waits for the end. Harmless when nothing runs.
  void Kill();

  bool running() const { return pid_ > 0; }
  pid_t pid() const { return pid_; }
  // Of the running process: resident memory, open file descriptors.
  std::size_t ResidentBytes() const;
  std::size_t Descriptors() const;

 private:
  void Close();

  pid_t pid_ = -1;    // -1: nothing runs
  int handle_ = -1;   // pidfd
  int output_ = -1;   // reading end of its standard output
  std::string text_;  // read and not yet taken
};

// arapd with flags, in a folder of its own that outlives every restart.
class ServerProcess : public ChildProcess {
 public:
  // Starts nothing. `flags` come after those that every test needs: free ports, a log on standard
  // error; sessions in memory and no limit of load unless they say so. "{}" in flag or address is
  // the folder.
  explicit ServerProcess(std::vector<std::string> flags = {}, std::string listen = "127.0.0.1:0");

  // Starts it with this command in front: "prlimit --nofile=200".
  void Under(std::vector<std::string> command) { command_ = std::move(command); }
  // From the next start on it is this program and not the arapd of this build.
  void UseProgram(std::string path) { program_ = std::move(path); }

  // Starts it and waits until it listens: false with a failure of the test, and the server's log in
  // it, when it does not within half a minute.
  bool Start();
  // The same for a server that should refuse: its exit code, nothing when it listens or hangs.
  std::optional<int> StartAndFail();

  const std::string& address() const { return address_; }
  const TempFolder& folder() const { return folder_; }
  // All that every start wrote to standard error.
  std::string Log() const;

 private:
  std::vector<std::string> Words() const;

  TempFolder folder_;
  std::vector<std::string> command_;
  std::string program_;
  std::vector<std::string> flags_;
  std::string listen_;
  std::string address_;
};

}  // namespace arap::fault
