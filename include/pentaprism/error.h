#pragma once
// What can go wrong, as one typed exception. Everything the library throws at its users is a pentaprism::Error.

#include <stdexcept>
#include <string>

namespace pentaprism {

/// The kind of a failure; the value is the exit code that the command line ends with.
enum class ErrorKind {
    kRender = 1,   ///< rendering failed (out of memory, a broken invariant)
    kUsage = 2,    ///< an option or setting has no meaning here
    kScene = 3,    ///< the scene cannot be read or cannot be trusted
    kOutput = 4,   ///< a file cannot be written
    kBackend = 5,  ///< the backend or library asked for is not available
};

/// `what()` is one line without the program's name: what was wrong, where (file, node, byte), and what to do.
class Error : public std::runtime_error {
  public:
    Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
    ErrorKind kind() const noexcept { return kind_; }

  private:
    ErrorKind kind_;
};

}  // namespace pentaprism
