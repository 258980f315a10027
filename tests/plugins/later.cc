// As a library of a later MASCOT begins: what follows the interface's number may be anything.
extern "C" const int mascot_plugin_law[] = {2, 0x5eed, 0x5eed, 0x5eed};
