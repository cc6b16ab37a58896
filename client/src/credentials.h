// ConnectOptions for gRPC.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <grpcpp/security/credentials.h>
#include <grpcpp/support/client_interceptor.h>

#include "arap/client/connect_options.h"
#include "arap/client/error.h"

namespace arap::client::internal {

using Interceptors =
    std::vector<std::unique_ptr<grpc::experimental::ClientInterceptorFactoryInterface>>;

// kInvalidOption with the field: a file that cannot be read, a certificate without key or the other
// way round, a token that is none or that would travel in plaintext to another machine.
Status Check(const std::string& address, const ConnectOptions& options);

// Reads the files; faults as Check.
Result<std::shared_ptr<grpc::ChannelCredentials>> CredentialsOf(const ConnectOptions& options);

// What adds the token to every call, on secure channels and others. Empty without a token.
Interceptors TokenSender(const ConnectOptions& options);

}  // namespace arap::client::internal
