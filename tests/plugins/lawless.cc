// A shared library that holds no law.
extern "C" int answer() { return 42; }
