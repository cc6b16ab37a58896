// Drags: streams that move one handle of a puppet, and compare every shape with one computed here.
#pragma once

#include <string>
#include <vector>

#include "arap/client/client.h"
#include "tests/system/cluster/crowd.h"

namespace arap::cluster {

// The places of the handles, and the shape that every server has to answer, to the last bit.
struct Pose {
  std::vector<Complex> places;
  std::vector<Complex> shape;
};

// A small puppet with two handles, "l" and "r", and a turn of "r" about "l".
struct Puppet {
  PlanarMesh mesh;
  std::vector<client::Handle> handles;
  std::vector<Pose> poses;
};
Puppet MakePuppet();

// An update that was answered by another stream than it was sent to: how long its user waited.
struct Interruption {
  std::chrono::steady_clock::time_point sent;
  double seconds = 0;
};

class Drags : public Crowd {
 public:
  // `count` streams, each with a session and a connection of its own, of an update every `period`.
  // Half of them want every update answered.
  Drags(const std::string& address, const Puppet& puppet, std::size_t count,
        std::chrono::milliseconds period);
  ~Drags() { Stop(); }

  // Whether every stream has had an answer before the time is over.
  bool AllMoved(std::chrono::seconds patience) const;

  // When they are told to stop, streams move to a last pose, close and read to the end. After Stop:
  std::size_t shapes() const { return shapes_; }
  std::size_t resumed() const { return resumed_; }
  // Streams that had the right last shape and ended well.
  std::size_t ended_well() const { return ended_well_; }
  const std::vector<Interruption>& interruptions() const { return interruptions_; }

 private:
  void Drag(std::size_t number);
  // False when the stream is over.
  bool Update(client::DeformStream& stream, std::uint64_t sequence, bool& resumed);
  bool Move(client::DeformStream& stream, std::uint64_t sequence);

  const std::string address_;
  const Puppet& puppet_;
  const std::size_t count_;
  const std::chrono::milliseconds period_;
  std::atomic<std::size_t> shapes_ = 0, resumed_ = 0, ended_well_ = 0, moving_ = 0;
  std::mutex interruptions_mutex_;
  std::vector<Interruption> interruptions_;  // guarded by it until Stop
};

}  // namespace arap::cluster
