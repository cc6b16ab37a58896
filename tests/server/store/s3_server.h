// S3Server: a real server of objects (s3rver of npm) for one test, on a free port.
#pragma once

#include <string>

#include <sys/types.h>

#include "server/store/blobs/s3_client.h"
#include "tests/server/store/temp_dir.h"

namespace arap::testing {

// It has one bucket, "arapd", and checks signatures.
class S3Server {
 public:
  // Whether the program is there.
  static bool Installed();

  S3Server();
  ~S3Server();
  S3Server(const S3Server&) = delete;
  S3Server& operator=(const S3Server&) = delete;

  // As who may do everything.
  store::S3Options Options() const;
  void Kill();     // SIGKILL, and waits for the end
  void Restart();  // on the same port, with what is on disk

 private:
  bool Start();

  TempDir dir_;
  int port_ = 0;
  pid_t process_ = -1;
};

}  // namespace arap::testing
