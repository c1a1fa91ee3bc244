/// \file
/// Leaks that are not ours, for the sanitizer: NRRD's library forgets headers it finds damaged.

extern "C" const char* __lsan_default_suppressions();  // NOLINT: the sanitizer's name.
extern "C" const char* __lsan_default_suppressions() { return "leak:libITKNrrdIO\n"; }
