// Write, sync, rename, sync the folder: the order that leaves either the old file or the whole new one after a crash.

#include "image/part_file.h"

#include <cerrno>
#include <fcntl.h>
#include <pentaprism/error.h>
#include <sys/file.h>
#include <sys/stat.h>
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

using Stat = struct stat;

bool is_same_file(const Stat& a, const Stat& b) {
    return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

// Opens the file empty, as the only process that writes it: the lock ends with the process, however that ends. Returns
// a descriptor, or -1 with errno; EBUSY if another process holds it. Where there are no locks, as on some network file
// systems, it does without.
int open_alone(const std::filesystem::path& part) {
    for (;;) {
        const int descriptor = ::open(part.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
        Stat opened{}, named{};
        if (descriptor < 0 || ::fstat(descriptor, &opened) != 0 || !S_ISREG(opened.st_mode)) return descriptor;
        if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
            ::close(descriptor);
            errno = EBUSY;
            return -1;
        }
        // Its name may have gone with the other process's file before the lock was had.
        if (::stat(part.c_str(), &named) == 0 && is_same_file(opened, named)) {
            if (::ftruncate(descriptor, 0) == 0) return descriptor;
            const int error = errno;
            ::close(descriptor);
            errno = error;
            return -1;
        }
        ::close(descriptor);
    }
}

// What a symbolic link leads to, so that it stays a link; one that leads nowhere is replaced.
std::filesystem::path followed(const std::filesystem::path& file) {
    std::error_code error;
    if (!std::filesystem::is_symlink(file, error)) return file;
    const std::filesystem::path target = std::filesystem::canonical(file, error);
    return error ? file : target;
}

}  // namespace

PartFile::PartFile(const std::filesystem::path& file) : file_(followed(file)), part_(file_) {
    part_ += ".part";
    std::error_code ignored;
    const std::filesystem::file_status there = std::filesystem::status(file_, ignored);
    if (std::filesystem::is_directory(there)) fail(EISDIR);
    // The rename would put a file in the place of a device or a pipe.
    if (std::filesystem::exists(there) && !std::filesystem::is_regular_file(there)) fail(ENODEV);
    const int descriptor = open_alone(part_);
    if (descriptor >= 0) stream_.reset(::fdopen(descriptor, "wb"));
    if (!stream_) fail(errno);
    lock_ = ::dup(descriptor);  // the lock outlives the stream, until the file has its name
}

PartFile::~PartFile() {
    if (stream_) {
        std::error_code ignored;
        std::filesystem::remove(part_, ignored);
    }
    if (lock_ >= 0) ::close(lock_);
}

void PartFile::fail(int system_error) {
    if (failure_.empty()) {
        const std::string why = system_error == EBUSY    ? "another process is writing it"
                                : system_error == ENODEV ? "it is no ordinary file"
                                                         : std::generic_category().message(system_error);
        failure_ = file_.string() + ": cannot write (" + why + ")";
    }
    throw Error(ErrorKind::kOutput, failure_);
}

void PartFile::throw_if_failed() const {
    if (!failure_.empty()) throw Error(ErrorKind::kOutput, failure_);
}

void PartFile::write(const void* bytes, std::size_t count) {
    if (count != 0 && std::fwrite(bytes, 1, count, stream_.get()) != count) fail(errno);
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
    sync_folder(file_.parent_path());
}

}  // namespace pentaprism
