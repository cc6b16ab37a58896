// Ctrl-C as something to look at.
#pragma once

#include <csignal>

namespace arap::cli {

// While one of these is there, the first SIGINT is only noted; the next ends the program.
// One at a time.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  bool happened() const;

 private:
  struct sigaction before_ {};
};

}  // namespace arap::cli
