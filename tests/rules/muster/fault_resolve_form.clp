; SPDX-License-Identifier: Apache-2.0
; options: library=no
; fails: 5 expected (on-resolve SCHEME FUNCTION)
(deffunction least (?rest ?sender) red)
(on-resolve busy 4)
