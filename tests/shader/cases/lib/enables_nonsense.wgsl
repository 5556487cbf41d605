// Imported by cases.
const two = 2.0;
enable telepathy;
