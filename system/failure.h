#pragma once

#include <exception>
#include <string>

namespace mascot {

/// Turns an exception that is not caught (for example in a thread of Fast DDS) into an error in words and exit code 1
/// (the default is SIGABRT). Also explains SIGBUS, by which a full /dev/shm ends a process.
void SayWhatIsUncaught();

/// What went wrong, in words: what() of most exceptions; for an exception because of missing memory or threads, words
/// that say so.
std::string InWords(const std::exception& failure);
/// The exception that is being handled, in words; of one that is no std::exception, its type.
std::string CaughtInWords();

}  // namespace mascot
