// SPDX-License-Identifier: Apache-2.0
#pragma once

// Compiled twice; the loader selects the version for the processor. Sanitizers start too late for
// that selection, so sanitized builds have the plain version only.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define TUINA_TWICE __attribute__((target_clones("arch=haswell", "default")))
#else
#define TUINA_TWICE
#endif
