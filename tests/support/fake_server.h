// FakeServer: a server without mathematics, for clients. Every shape is the mesh at rest and every
// layout the surface seen from above. It is honest until a test says otherwise.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <google/protobuf/message.h>
#include <grpcpp/support/status.h>

namespace arap::testing {

// Thread-safe; change it before the calls that it is to change. Methods are named as in the
// protocol: "Deform".
class FakeServer {
 public:
  // Listens on a free port of 127.0.0.1.
  FakeServer();
  // Calls that are open are cancelled.
  ~FakeServer();
  FakeServer(const FakeServer&) = delete;
  FakeServer& operator=(const FakeServer&) = delete;

  std::string address() const;

  // Every answer of this type is changed before it is sent. Shapes are changed wherever they are:
  // Change<v1::Shape>([](v1::Shape& shape) { shape.clear_positions(); });
  template <class Answer>
  void Change(std::function<void(Answer&)> change) {
    ChangeAs(Answer::descriptor()->full_name(),
             [change](google::protobuf::Message& answer) { change(static_cast<Answer&>(answer)); });
  }

  // The next calls of a method end like this, one after the other: without being carried out, or
  // after they were; watching a job and fetching its result end after a piece of the answer.
  // Streams and tracks are only ever refused.
  void Refuse(const std::string& method, std::vector<grpc::Status> statuses);
  void LoseTheAnswer(const std::string& method, std::vector<grpc::Status> statuses);
  // Nothing is said on calls of this method, until they are cancelled. A stream still reads.
  void Hush(const std::string& method);
  // A stream opens and answers pings, and no update.
  void AnswerOnlyPings();
  // So many frames are answered to tracks, however many were asked.
  void AnswerFrames(std::uint64_t count);

  int calls(const std::string& method) const;
  // A header of the last call of the method, or empty.
  std::string header(const std::string& method, const std::string& name) const;

  struct State;  // for the services of which it is made

 private:
  void ChangeAs(const std::string& type, std::function<void(google::protobuf::Message&)> change);

  std::unique_ptr<State> state_;
};

}  // namespace arap::testing
