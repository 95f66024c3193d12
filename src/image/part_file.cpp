// Write, sync, rename, sync the folder: the order that leaves either the old file or the whole new one after a crash.

#include "image/part_file.h"

#include <cerrno>
#include <fcntl.h>
#include <pentaprism/error.h>
#include <system_error>
#include <unistd.h>

namespace pentaprism {
namespace {

// Devices and some network file systems cannot sync and say so; that is no failure of the data.
bool is_real_sync_error(int error) {
    return error != EINVAL && error != ENOTSUP && error != EROFS;
}

// The rename itself lies in the folder; not every system lets a folder be opened, so a failure here is not one of the
// file.
void sync_folder(const std::filesystem::path& folder) {
    const int descriptor = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) return;
    ::fsync(descriptor);
    ::close(descriptor);
}

}  // namespace

PartFile::PartFile(const std::filesystem::path& file) : file_(file), part_(file) {
    part_ += ".part";
    std::error_code ignored;
    if (std::filesystem::is_directory(file_, ignored)) fail(EISDIR);
    stream_.reset(std::fopen(part_.c_str(), "wbe"));
    if (!stream_) fail(errno);
}

PartFile::~PartFile() {
    if (committed_ || !stream_) return;
    stream_.reset();
    std::error_code ignored;
    std::filesystem::remove(part_, ignored);
}

void PartFile::fail(int system_error) {
    if (failure_.empty()) {
        failure_ = file_.string() + ": cannot write (" + std::generic_category().message(system_error) + ")";
    }
    throw Error(ErrorKind::kOutput, failure_);
}

void PartFile::throw_if_failed() const {
    if (!failure_.empty()) throw Error(ErrorKind::kOutput, failure_);
}

void PartFile::write(const void* bytes, std::size_t count) {
    if (std::fwrite(bytes, 1, count, stream_.get()) != count) fail(errno);
}

std::uint64_t PartFile::position() {
    const off_t position = ::ftello(stream_.get());
    if (position < 0) fail(errno);
    return static_cast<std::uint64_t>(position);
}

void PartFile::seek(std::uint64_t position) {
    if (::fseeko(stream_.get(), static_cast<off_t>(position), SEEK_SET) != 0) fail(errno);
}

void PartFile::commit() {
    throw_if_failed();
    if (std::fflush(stream_.get()) != 0) fail(errno);
    if (::fsync(::fileno(stream_.get())) != 0 && is_real_sync_error(errno)) fail(errno);
    // Some systems report a full disk or quota only here.
    if (std::FILE* stream = stream_.release(); std::fclose(stream) != 0) {
        const int error = errno;
        ::unlink(part_.c_str());
        fail(error);
    }
    if (std::rename(part_.c_str(), file_.c_str()) != 0) {
        const int error = errno;
        ::unlink(part_.c_str());
        fail(error);
    }
    committed_ = true;
    sync_folder(file_.parent_path());
}

}  // namespace pentaprism
