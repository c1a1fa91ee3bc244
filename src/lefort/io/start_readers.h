/// \file
/// The processes that read untrusted files.
#pragma once

namespace lefort::io {

/// Starts the process from which the readers of files fork. A program calls it first, before it has
/// threads, opens files or reads anything: what exists later is then not in the memory of a reader.
/// Without this call, the first reader starts it. It ends with the program.
void start_readers();

/// Ends that process, and waits until it has ended. No reader may be running.
void stop_readers();

}  // namespace lefort::io
