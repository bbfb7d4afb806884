/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/node/node.h"

#include "broker/node/disk_parts.h"

bool disk_run(struct disk *d, const char *sql)
{
    return sqlite3_exec(d->db, sql, NULL, NULL, NULL) == SQLITE_OK;
}

bool disk_step(sqlite3_stmt *statement)
{
    int result = sqlite3_step(statement);
    (void)sqlite3_reset(statement); /* says again what the step has said */
    return result == SQLITE_DONE;
}
