#include "server/host/tls_files.h"

#include <cerrno>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

namespace arap::host {
namespace {

std::string PathOf(int descriptor) { return "/proc/self/fd/" + std::to_string(descriptor); }

std::string TextOf(const std::string& path) {
  std::ostringstream text;
  if (!path.empty()) text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

// A file in memory that holds `text`, or -1.
int InMemory(const std::string& text) {
  const int descriptor = memfd_create("arapd-tls", MFD_CLOEXEC);
  if (descriptor < 0) return -1;
  if (write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size())) {
    return descriptor;
  }
  close(descriptor);
  return -1;
}

std::array<std::string*, 3> PathsIn(TlsOptions& tls) {
  return {&tls.certificate, &tls.key, &tls.client_ca};
}

// Files in memory, closed unless they are taken.
struct Fresh {
  std::array<int, 3> descriptors{-1, -1, -1};
  ~Fresh() {
    for (const int descriptor : descriptors) {
      if (descriptor >= 0) close(descriptor);
    }
  }
};

}  // namespace

Result<std::unique_ptr<TlsFiles>> TlsFiles::Open(const TlsOptions& tls) {
  if (auto good = CheckTls(tls); !good) return Fail(std::move(good.error()));
  std::unique_ptr<TlsFiles> files(new TlsFiles(tls));
  if (!tls.given()) return files;
  if (auto read = files->Refresh(true); !read) return Fail(std::move(read.error()));
  return files;
}

TlsFiles::~TlsFiles() {
  for (const int descriptor : descriptors_) {
    if (descriptor >= 0) close(descriptor);
  }
}

Result<bool> TlsFiles::Refresh(bool insist) {
  const std::lock_guard lock(mutex_);
  TlsOptions files = files_;
  Texts texts;
  for (std::size_t i = 0; i < kFiles; ++i) texts[i] = TextOf(*PathsIn(files)[i]);
  if (texts == texts_ || (texts == refused_ && !insist)) return false;
  refused_ = texts;
  Fresh fresh;
  TlsOptions checked = files_;
  for (std::size_t i = 0; i < kFiles; ++i) {
    std::string& path = *PathsIn(checked)[i];
    if (path.empty()) continue;
    fresh.descriptors[i] = InMemory(texts[i]);
    if (fresh.descriptors[i] < 0) {
      return Fail(FaultKind::kInternal,
                  "No memory for the certificates: " + std::generic_category().message(errno));
    }
    path = PathOf(fresh.descriptors[i]);
  }
  // What was read is what counts; the names of the files are for the message.
  if (auto good = CheckTls(checked); !good) {
    if (auto named = CheckTls(files_); !named) return Fail(std::move(named.error()));
    return Fail(std::move(good.error()));
  }
  for (std::size_t i = 0; i < kFiles; ++i) {
    if (descriptors_[i] < 0) {
      descriptors_[i] = std::exchange(fresh.descriptors[i], -1);
    } else if (dup3(fresh.descriptors[i], descriptors_[i], O_CLOEXEC) < 0) {
      return Fail(FaultKind::kInternal, "The certificates cannot be put in place: " +
                                            std::generic_category().message(errno));
    }
    if (descriptors_[i] >= 0) *PathsIn(copies_)[i] = PathOf(descriptors_[i]);
  }
  texts_ = std::move(texts);
  refused_ = {};
  return true;
}

}  // namespace arap::host
