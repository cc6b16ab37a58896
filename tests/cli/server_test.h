// A private server for tests of the client library, and a small mesh with two handles.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "arap/client/client.h"
#include "client/cli/connect/connection.h"
#include "client/cli/sample/samples.h"

namespace arap::cli {

class ServerTest : public testing::Test {
 protected:
  void SetUp() override {
    Result<Connection> connection = Connection::Open({{}, /*spawn=*/true});
    ASSERT_TRUE(connection) << connection.error().message;
    connection_ = std::move(*connection);
  }

  const client::Client& client() const { return connection_->client(); }

  client::Session NewSession() const {
    const auto session = client().CreateSession();
    EXPECT_TRUE(session) << session.error().message;
    return *session;
  }

  // 8 × 8 unit squares.
  static PlanarMesh Mesh() { return MakeGrid(9, 9); }

  // The handle "left" at vertex 0 and "right" at vertex 8, the lower corners, on the mesh "mesh".
  static void Compile(const client::Session& session, const std::string& set) {
    const auto mesh = session.RegisterMesh(Mesh(), {}, "mesh");
    ASSERT_TRUE(mesh) << mesh.error().message;
    const std::vector<client::Handle> handles{{"left", client::VertexAnchor{0}},
                                              {"right", client::VertexAnchor{8}}};
    const auto compiled = session.CompileHandles(set, "mesh", handles);
    ASSERT_TRUE(compiled) << compiled.error().message;
  }

 private:
  std::optional<Connection> connection_;
};

}  // namespace arap::cli
