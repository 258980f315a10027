// Beginning of a library for a later MASCOT: after the interface version, anything may follow.
extern "C" const int mascot_plugin_law[] = {4, 0x5eed, 0x5eed, 0x5eed};
