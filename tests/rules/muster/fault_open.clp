; SPDX-License-Identifier: Apache-2.0
; fails: 4 a parenthesis is never closed

(defrule bad (a) => (stop)
