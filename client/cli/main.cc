// arapctl: the command line of arapd.
#include "client/cli/command_line.h"

int main(int argc, char** argv) {
  return arap::cli::RunCommandLine({argv + (argc > 0 ? 1 : 0), argv + argc}, ARAP_VERSION);
}
