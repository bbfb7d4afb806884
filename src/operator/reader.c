/* SPDX-License-Identifier: Apache-2.0 */
#include "operator/operator.h"

#include "core/name.h"

#include <stdio.h>
#include <unistd.h>

enum { READERS = 64, READERS_THAT_STAY = 192 };

void reader_name(char name[MU_NAME_MAX + 1], unsigned attempt, bool stays)
{
    unsigned names = stays ? READERS_THAT_STAY : READERS;
    unsigned number = ((unsigned)getpid() + attempt) % names;
    snprintf(name, MU_NAME_MAX + 1, "operator-%u", number + (stays ? READERS : 0));
}

bool reader_is(const struct mu_member *m)
{
    return m->kind == MU_KIND_SPECIAL && mu_name_of_operator(m->name);
}
