// A library with an undefined symbol.
extern "C" double mascot_test_gain_that_nobody_defines();
extern "C" double twice() { return 2 * mascot_test_gain_that_nobody_defines(); }
