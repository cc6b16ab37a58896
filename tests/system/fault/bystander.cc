#include "tests/system/fault/bystander.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace arap::fault {
namespace {

using std::chrono::steady_clock;

constexpr std::uint32_t kSize = 8;

}  // namespace

Bystander::Bystander(const std::string& address) : client_(address) {
  EXPECT_TRUE(client_.CreateSession("bystander").ok());
  EXPECT_TRUE(client_.Register("bystander", "m", wire::Grid(kSize, kSize)).ok());
  EXPECT_TRUE(client_
                  .Compile("bystander", "m", "h",
                           {wire::VertexHandle("left", 0), wire::VertexHandle("right", kSize)})
                  .ok());
  thread_ = std::thread([this] { Run(); });
}

Bystander::~Bystander() { Stop(); }

bool Bystander::GoesOn(std::size_t count) const {
  const std::size_t until = frames_ + count;
  return Eventually([&] { return frames_ >= until; });
}

void Bystander::Stop() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

void Bystander::Run() {
  wire::DeformStream stream(client_.deformation());
  stream.Opened("bystander", "h", v1::DELIVERY_EVERY);
  for (std::uint64_t sequence = 1; !stop_; ++sequence) {
    const auto sent = steady_clock::now();
    stream.Update(sequence, {wire::TargetAt("right", kSize, static_cast<double>(sequence % 5))});
    const auto answer = stream.Read();
    if (!answer || !answer->has_shape()) {
      ADD_FAILURE() << "no shape: "
                    << (answer ? answer->ShortDebugString() : stream.Finish().error_message());
      return;
    }
    const auto took =
        std::chrono::duration_cast<std::chrono::milliseconds>(steady_clock::now() - sent).count();
    slowest_ = std::max<long>(slowest_, took);
    ++frames_;
  }
  stream.HalfClose();
  EXPECT_FALSE(stream.Read());
  EXPECT_TRUE(stream.Finish().ok());
}

}  // namespace arap::fault
