/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file border.h
 * Checks of everything that comes from the network, made once; behind it, samples can be trusted
 * to be whole and bounded.
 */
#ifndef MUSTER_BROKER_BORDER_H
#define MUSTER_BROKER_BORDER_H

#include "wire.h"

#include <stdbool.h>
#include <stddef.h>

/** @return whether s is a string of at most max bytes */
bool border_string(const char *s, size_t max);

/** Checks the frame of a Registration; its entries are looked at one by one. */
bool border_registration(const muster_Registration *r);

/** @return whether what is said of an agent fits; its name may still be no good one */
bool border_entry(const muster_Entry *e, bool of_a_broker);

bool border_roster(const muster_Roster *r);

/** Checks the frame of an Up; its mails are looked at one by one. */
bool border_up(const muster_Up *up);

/** Checks all of a mail but its sender. */
bool border_mail(const muster_Mail *m);

#endif
