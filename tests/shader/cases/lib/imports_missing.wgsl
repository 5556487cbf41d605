// Imported by cases.
#import "beyond_all_reach.wgsl"
