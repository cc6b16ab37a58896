// The rule for names and the faults of those that are not there or taken.
#pragma once

#include "core/base/names.h"
#include "server/budget/faults.h"
