#pragma once
#include "sse2.h"
