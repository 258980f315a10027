// Beginning of a library for an earlier MASCOT, whose laws had no Set().
extern "C" const int mascot_plugin_law[] = {1, 0x5eed, 0x5eed, 0x5eed};
