#include "tests/server/store/disk.h"

#include <csignal>

#include <fcntl.h>
#include <linux/fs.h>
#include <sys/ioctl.h>
#include <sys/mount.h>
#include <unistd.h>

#include "core/base/files.h"

namespace arap::testing {

TinyDisk::TinyDisk()
    : mounted_(mount("tmpfs", dir_.path().c_str(), "tmpfs", 0, "size=2m,mode=0700") == 0) {}

TinyDisk::~TinyDisk() {
  if (mounted_) umount2(dir_.path().c_str(), MNT_DETACH);
}

void TinyDisk::Fill() {
  const File file(open((dir_ / "filler").c_str(), O_WRONLY | O_CREAT, 0600));
  for (const std::size_t size : {65536u, 4096u, 1u}) {
    const std::string bytes(size, 'x');
    lseek(file.fd(), 0, SEEK_END);
    while (write(file.fd(), bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size())) {
    }
  }
}

void TinyDisk::Free() { unlink((dir_ / "filler").c_str()); }

bool TinyDisk::SetReadOnly(bool read_only) {
  const unsigned long flags = MS_REMOUNT | (read_only ? MS_RDONLY : 0);
  return mount("tmpfs", dir_.path().c_str(), "tmpfs", flags, "size=2m") == 0;
}

FileSizeLimit::FileSizeLimit(rlim_t bytes) {
  std::signal(SIGXFSZ, SIG_IGN);
  getrlimit(RLIMIT_FSIZE, &before_);
  rlimit limit = before_;
  limit.rlim_cur = bytes;
  setrlimit(RLIMIT_FSIZE, &limit);
}

FileSizeLimit::~FileSizeLimit() { setrlimit(RLIMIT_FSIZE, &before_); }

bool SetImmutable(const std::string& path, bool immutable) {
  const File file(open(path.c_str(), O_RDONLY | O_CLOEXEC));
  int flags = 0;
  if (!file || ioctl(file.fd(), FS_IOC_GETFLAGS, &flags) != 0) return false;
  const auto bit = static_cast<int>(FS_IMMUTABLE_FL);
  flags = immutable ? flags | bit : flags & ~bit;
  return ioctl(file.fd(), FS_IOC_SETFLAGS, &flags) == 0;
}

}  // namespace arap::testing
