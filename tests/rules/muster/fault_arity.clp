; SPDX-License-Identifier: Apache-2.0
; fails: 3 Function setSpeed expected exactly 2 argument(s)
(defrule bad (a) => (setSpeed 1))
