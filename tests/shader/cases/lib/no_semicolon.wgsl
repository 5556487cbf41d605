// Imported by cases.
const one = 1.0
// Nothing follows.
