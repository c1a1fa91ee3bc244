#include <lefort/io/internal/silence_libraries.h>

#include <itkObject.h>
#include <itkOutputWindow.h>

#include <iostream>

namespace lefort::io {

namespace {

/// Receives ITK's warnings.
class NoOutputWindow : public itk::OutputWindow {
 public:
  using Self = NoOutputWindow;
  using Superclass = itk::OutputWindow;
  using Pointer = itk::SmartPointer<Self>;
  itkFactorylessNewMacro(Self);
  itkTypeMacro(NoOutputWindow, OutputWindow);

  void DisplayText(const char* /*text*/) override {}
};

/// Discards its input.
class NoStream : public std::streambuf {
  int_type overflow(int_type c) override { return traits_type::not_eof(c); }
  std::streamsize xsputn(const char* /*text*/, std::streamsize count) override { return count; }
};

NoStream no_stream;

// State of the process, as that of the libraries is.
std::mutex one_at_a_time;

}  // namespace

SilenceLibraries::SilenceLibraries()
    : turn_(one_at_a_time), cerr_(std::cerr.rdbuf(&no_stream)), cout_(std::cout.rdbuf(&no_stream)) {
  itk::OutputWindow::SetInstance(NoOutputWindow::New());
}

SilenceLibraries::~SilenceLibraries() {
  std::cerr.rdbuf(cerr_);
  std::cout.rdbuf(cout_);
}

}  // namespace lefort::io
