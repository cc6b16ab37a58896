// S3Server: a real server of objects (s3rver of npm) for one test, on a free port.
#pragma once

#include "server/store/blobs/s3_client.h"
#include "tests/server/store/local_server.h"
#include "tests/server/store/temp_dir.h"

namespace arap::testing {

// It has one bucket, "arapd", and checks signatures.
class S3Server {
 public:
  // Whether the program is there.
  static bool Installed();

  S3Server();

  // As who may do everything.
  store::S3Options Options() const;
  void Kill() { server_.Kill(); }
  void Restart() { server_.Restart(); }  // with what is on disk

 private:
  TempDir dir_;
  LocalServer server_;  // last: it uses the folder
};

}  // namespace arap::testing
