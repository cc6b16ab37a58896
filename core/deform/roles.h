// Deciding from the structure alone what can be solved: roles of components, independent hard rows.
// Never from a determinant or the luck of a factorisation [algorithm §5].
#pragma once

#include "core/deform/compiled_parts.h"

namespace arap {

// Fills roles, active_slot, active_components, active_rows and dependent from handles and rows.
void DecideRoles(CompiledHandlesParts& parts);

}  // namespace arap
