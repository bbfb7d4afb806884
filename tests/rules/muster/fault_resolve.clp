; SPDX-License-Identifier: Apache-2.0
; options: library=no
; fails: 6 no deffunction least that takes two arguments: rest, sender
(deffunction least (?rest) red)
; The function is there, but cannot be called with an address and its sender.
(on-resolve busy least)
