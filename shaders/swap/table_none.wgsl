// Stands in for the texture table if the host reads its textures itself or has none.
