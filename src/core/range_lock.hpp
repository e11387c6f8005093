#pragma once

#include <cstdint>
#include <string>

#include "corda/core/file.hpp"

namespace corda {

/// Keeps other renders from some numbers of what is written under one name, by a lock file that is there
/// meanwhile. Others may hold other numbers.
class RangeLock {
  public:
    /// Locks `first` to `end`, without it; `path` is the lock file's. Throws corda::Error (kIo) if another
    /// render holds one of them, or if there can be no such file. A file system without locks locks nothing.
    RangeLock(std::string path, std::int64_t first, std::int64_t end, const std::string& what);
    RangeLock(const RangeLock&) = delete;
    RangeLock& operator=(const RangeLock&) = delete;
    ~RangeLock();

  private:
    std::string path_;
    Descriptor file_;
};

}  // namespace corda
