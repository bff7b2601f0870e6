// No texture table: the host reads its textures itself, or has none.
