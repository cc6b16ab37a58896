// How a DeformStream behaves.
#pragma once

#include <chrono>

#include "arap/client/shape.h"

namespace arap::client {

// Which updates are answered.
enum class Delivery {
  kLatest,  // a new update replaces one that has not started; for interaction
  kEvery,   // every update is answered; for baking
};

struct StreamOptions {
  Delivery delivery = Delivery::kLatest;
  DeformOptions deform = {};

  // After this much silence the server is asked for a sign of life; 0: never. The stream then
  // counts as used also when nobody moves a handle, and a server that is gone is noticed also
  // behind a proxy that answers for it.
  std::chrono::milliseconds heartbeat = std::chrono::seconds(5);
  // A Read, or an opening, that hears nothing for so long counts the server as gone. Longer than
  // the longest frame: a server that works on one may answer late, and after CloseSending it cannot
  // be asked. Without heartbeat it counts for nothing.
  std::chrono::milliseconds silence = std::chrono::seconds(30);

  // For how long a stream that was lost is opened again and again, growing pauses of up to 2 s
  // apart, until the server has caught up; 0: not at all. An attempt under way is not cut short; it
  // ends with an answer or after `silence`. Lost is what ended with the server gone or going away:
  // silence, UNAVAILABLE, and what proxies make of it: UNKNOWN "No status received", INTERNAL
  // "RST_STREAM", CANCELLED. After silence the next attempt is made over a new connection. A server
  // that has no room (RESOURCE_EXHAUSTED) is asked again too. Anything else is final.
  std::chrono::milliseconds resume_within{0};
};

}  // namespace arap::client
