// The standard sampler that filters and holds the edge.

var linear_clamp: sampler;
