// Attacks by somebody who never says who he is.
#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <poll.h>
#include <sys/socket.h>
#include <zlib.h>

#include "tests/attack/attacker.h"
#include "tests/attack/http2_client.h"

namespace arap::attack {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::size_t kMegabyte = std::size_t{1} << 20u;
constexpr const char* kFrom = "127.0.0.2";
constexpr const char* kRegister = "/arap.v1.DeformationService/RegisterMesh";
constexpr const char* kStream = "/arap.v1.DeformationService/StreamDeform";
constexpr const char* kWatch = "/grpc.health.v1.Health/Watch";

std::vector<Http2Client> Connect(const Attacker& attacker, std::size_t count) {
  std::vector<Http2Client> clients;
  clients.reserve(count);
  for (std::size_t i = 0; i < count; ++i) clients.emplace_back(attacker.address(), kFrom);
  return clients;
}

void AppendNumber(std::uint32_t value, bool big_endian, std::string& out) {
  for (unsigned i = 0; i < 4; ++i) {
    out.push_back(static_cast<char>(value >> (big_endian ? 24 - 8 * i : 8 * i) & 0xFFu));
  }
}

// `megabytes` of zeros in the format gzip or zlib ("deflate" in gRPC): a thousandth of that. Each
// megabyte is a block of the same bytes, so it is compressed once.
std::string Bomb(std::size_t megabytes, bool gzip) {
  const std::string zeros(kMegabyte, '\0');
  const auto* const bytes = reinterpret_cast<const Bytef*>(zeros.data());
  constexpr int kRaw = -15, kMemoryLevel = 9;
  z_stream stream{};
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, kRaw, kMemoryLevel,
                   Z_DEFAULT_STRATEGY) != Z_OK) {
    return {};
  }
  std::string block(kMegabyte, '\0');
  stream.next_in = const_cast<Bytef*>(bytes);
  stream.avail_in = kMegabyte;
  stream.next_out = reinterpret_cast<Bytef*>(block.data());
  stream.avail_out = kMegabyte;
  deflate(&stream, Z_FULL_FLUSH);
  block.resize(kMegabyte - stream.avail_out);
  deflateEnd(&stream);

  std::string bomb = gzip ? std::string("\x1f\x8b\x08\0\0\0\0\0\0\x03", 10) : "\x78\x9c";
  uLong check = gzip ? crc32(0, nullptr, 0) : adler32(0, nullptr, 0);
  const uLong of_one = gzip ? crc32(check, bytes, kMegabyte) : adler32(check, bytes, kMegabyte);
  for (std::size_t i = 0; i < megabytes; ++i) {
    bomb += block;
    check =
        gzip ? crc32_combine(check, of_one, kMegabyte) : adler32_combine(check, of_one, kMegabyte);
  }
  bomb += std::string("\x03\0", 2);  // an empty last block
  AppendNumber(static_cast<std::uint32_t>(check), !gzip, bomb);
  if (gzip) AppendNumber(static_cast<std::uint32_t>(megabytes * kMegabyte), false, bomb);
  return bomb;
}

// A call with a message of a gigabyte that travels as one of a megabyte.
void CompressionBomb(Attacker& attacker) {
  const std::string bombs[] = {Bomb(1'024, true), Bomb(1'024, false)};
  attacker.Begin();
  attacker.Loop(2, [&](int i) {
    const std::string& bomb = bombs[i];
    Http2Client client(attacker.address(), kFrom);
    const auto call = client.OpenCall(kRegister, {{"grpc-encoding", i == 0 ? "gzip" : "deflate"}});
    const bool sent = client.Send(call, MessagePrefix(true, bomb.size()) + bomb, true);
    attacker.Spend(1, sent ? bomb.size() : 0);
    for (int k = 0; k < 50 && client.open(); ++k) client.Pump(milliseconds(20));
  });
}

// As many connections as there are descriptors: nothing is said on them. Opened, closed, and again.
void SilentConnections(Attacker& attacker) {
  constexpr int kConnections = 6'000;
  attacker.Begin();
  attacker.Loop(1, [&](int) {
    std::vector<Http2Client> silent;
    for (int i = 0; i < kConnections; ++i) {
      Http2Client client(attacker.address(), i % 2 == 0 ? kFrom : "127.0.0.3");
      if (!client.open()) break;
      silent.push_back(std::move(client));
      attacker.Spend(1);
    }
    poll(nullptr, 0, 1'500);
  });
}

// Uploads as large as they may be that stop one byte before their end.
void ShortUploads(Attacker& attacker) {
  constexpr std::size_t kSize = 63 * kMegabyte;
  const std::string upload = MessagePrefix(false, kSize) + std::string(kSize - 1, 'x');
  attacker.Begin();
  std::vector<Http2Client> held = Connect(attacker, 24);
  attacker.Loop(2, [&](int part) {
    for (std::size_t i = static_cast<std::size_t>(part); i < held.size(); i += 2) {
      const auto call = held[i].OpenCall(kRegister);
      const bool sent = held[i].Send(call, upload, false);
      attacker.Spend(1, sent ? upload.size() : 0);
      if (!held[i].open()) held[i] = {attacker.address(), kFrom};
    }
  });
}

// Opens calls of `path` without end, four connections; `body` goes with each.
void FloodOf(Attacker& attacker, const char* path, const std::string& body) {
  attacker.Begin();
  std::vector<Http2Client> clients = Connect(attacker, 4);
  attacker.Loop(1, [&](int) {
    for (Http2Client& client : clients) {
      for (int i = 0; i < 100; ++i) {
        const auto call = client.OpenCall(path);
        if (call == 0) break;
        if (!body.empty()) client.Send(call, body, false, milliseconds(0));
        attacker.Spend(1);
      }
      client.Pump(milliseconds(0));
      if (!client.open()) client = {attacker.address(), kFrom};
    }
  });
}

void HeadersOnly(Attacker& attacker) { FloodOf(attacker, kStream, {}); }
void HealthWatch(Attacker& attacker) { FloodOf(attacker, kWatch, MessagePrefix(false, 0)); }

// Calls that are taken back as soon as they are begun.
void RapidReset(Attacker& attacker) {
  attacker.Begin();
  std::vector<Http2Client> clients = Connect(attacker, 4);
  attacker.Loop(1, [&](int) {
    for (Http2Client& client : clients) {
      for (int i = 0; i < 100; ++i) {
        const auto call = client.OpenCall(kStream);
        if (call == 0 || !client.Reset(call)) break;
        attacker.Spend(1);
      }
      client.Pump(milliseconds(0));
      if (!client.open()) client = {attacker.address(), kFrom};
    }
  });
}

// Tokens that look right and belong to nobody.
void WrongTokens(Attacker& attacker) {
  attacker.Begin();
  std::vector<std::unique_ptr<fault::FaultClient>> clients;
  clients.reserve(8);
  for (int i = 0; i < 8; ++i) {
    clients.push_back(std::make_unique<fault::FaultClient>(
        attacker.address(), "arapd_" + std::string(32, static_cast<char>('a' + i % 6)) + "_" +
                                std::string(64, static_cast<char>('0' + i))));
  }
  attacker.Loop(16, [&](int i) {
    attacker.Count(clients[static_cast<std::size_t>(i % 8)]->CreateSession("mine"));
  });
}

// Headers that are large and many.
void LargeHeaders(Attacker& attacker) {
  Http2Client::Headers headers;
  for (int i = 0; i < 100; ++i) {
    headers.emplace_back("x-" + std::to_string(i), std::string(120, 'y'));
  }
  attacker.Begin();
  std::vector<Http2Client> clients = Connect(attacker, 4);
  attacker.Loop(1, [&](int) {
    for (Http2Client& client : clients) {
      if (client.OpenCall(kStream, headers) != 0) attacker.Spend(1, 13'000);
      client.Pump(milliseconds(0));
      if (!client.open()) client = {attacker.address(), kFrom};
    }
  });
}

// Clients of the admin page that say a letter a second.
void SlowAdmin(Attacker& attacker) {
  constexpr std::string_view kRequest = "GET /metrics HTTP/1.1\r\nHost: a\r\nX-Long: ";
  std::vector<int> sockets;
  attacker.Begin();
  std::size_t at = 0;
  attacker.Loop(1, [&](int) {
    while (sockets.size() < 64) {
      const int socket = ConnectTo(attacker.admin(), kFrom);
      if (socket < 0) break;
      sockets.push_back(socket);
      attacker.Spend(1);
    }
    const char letter = at < kRequest.size() ? kRequest[at] : 'x';
    ++at;
    for (const int socket : sockets) {
      if (send(socket, &letter, 1, MSG_NOSIGNAL | MSG_DONTWAIT) == 1) attacker.Spend(0, 1);
    }
    poll(nullptr, 0, 200);
  });
}

}  // namespace

std::vector<Attack> AttacksBeforeIdentity() {
  return {
      {"nothing", "nobody attacks: how steady this machine is", [](Attacker& a) { a.Begin(); }},
      {"compression-bomb", "messages of a gigabyte that travel as a megabyte, gzip and deflate",
       CompressionBomb},
      {"silent-connections", "connections beyond all descriptors, opened and closed",
       SilentConnections},
      {"short-uploads", "24 uploads of 63 MB that stop one byte short", ShortUploads},
      {"headers-only", "calls without a message, as many as go", HeadersOnly},
      {"health-watch", "watches of the health service, as many as go", HealthWatch},
      {"rapid-reset", "calls that are taken back at once", RapidReset},
      {"wrong-tokens", "16 callers with tokens of nobody", WrongTokens},
      {"large-headers", "calls with 13 KB of headers", LargeHeaders},
      {"slow-admin", "64 clients of the admin page that say a letter now and then", SlowAdmin},
  };
}

}  // namespace arap::attack
