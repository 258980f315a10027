// A shared library without a law.
extern "C" int answer() { return 42; }
