//! The members of a struct as Rust lays them out, and as WGSL does. The demo's tests include this file too.

use wgpu::naga;

/// Name, offset and size of each member in order, and the size of the whole. Padding is left out: the members around it
/// show if it is wrong.
pub type Layout = (Vec<(String, u32, u32)>, u32);

/// The layout of a `Zeroable` Rust struct. Does not compile unless all of its fields are named; their order is the
/// memory's.
macro_rules! rust_layout {
    ($type:path { $($field:ident),* $(,)? }) => {{
        let value: $type = bytemuck::Zeroable::zeroed();
        let $type { $($field),* } = &value;
        let mut members = vec![
            $((stringify!($field).to_owned(), std::mem::offset_of!($type, $field) as u32, size_of_val($field) as u32)),*
        ];
        members.sort_by_key(|m| m.1);
        members.retain(|m| m.0 != "padding");
        (members, size_of::<$type>() as u32)
    }};
}
pub(crate) use rust_layout;

/// The layout of a struct of a module.
pub fn wgsl_layout(module: &naga::Module, name: &str) -> Layout {
    let mut layouter = naga::proc::Layouter::default();
    layouter.update(module.to_ctx()).expect("a valid module");
    let mut structs = module.types.iter().filter(|(_, ty)| ty.name.as_deref() == Some(name));
    let Some((_, naga::Type { inner: naga::TypeInner::Struct { members, span }, .. })) = structs.next() else {
        panic!("the module has no struct {name}")
    };
    let member = |m: &naga::StructMember| (m.name.clone().unwrap_or_default(), m.offset, layouter[m.ty].size);
    (members.iter().map(member).filter(|m| !m.0.starts_with("padding")).collect(), *span)
}

/// Parses and validates, as wgpu will.
pub fn parse(source: &str) -> naga::Module {
    let module = naga::front::wgsl::parse_str(source).unwrap_or_else(|e| panic!("{}", e.emit_to_string(source)));
    let mut validator =
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::all());
    if let Err(e) = validator.validate(&module) {
        panic!("{}", e.emit_to_string(source));
    }
    module
}

/// The value of a `const` of type u32.
pub fn constant(module: &naga::Module, name: &str) -> u32 {
    let found = module.constants.iter().find(|(_, c)| c.name.as_deref() == Some(name));
    let (_, c) = found.unwrap_or_else(|| panic!("the module has no const {name}"));
    match module.global_expressions[c.init] {
        naga::Expression::Literal(naga::Literal::U32(value)) => value,
        ref other => panic!("{name} is {other:?}"),
    }
}
