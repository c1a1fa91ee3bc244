#include <lefort/app/run_program.h>

int main(int argc, char** argv) { return lefort::app::run_program(argc, argv); }
